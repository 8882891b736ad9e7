#include <rayloom/base/stack_memory.h>

#include <rayloom/base/fiber_context.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

using rayloom::Fiber;
using namespace rayloom::detail;

TEST_CASE("a stack given back is the next one of its size", "[fiber][stack_memory]") {
  const size_t bytes = 7 * page_bytes(), other_bytes = 9 * page_bytes();
  std::byte* const stack = take_stack(bytes);
  std::memset(stack, 0x5A, bytes);
  give_back_stack(stack, bytes);
  std::byte* const other = take_stack(other_bytes);
  CHECK(other != stack);
  CHECK(take_stack(bytes) == stack);
  std::memset(stack, 0xA5, bytes);
  give_back_stack(other, other_bytes);
  give_back_stack(stack, bytes);
}

TEST_CASE("stacks in use never overlap, in threads that come and go", "[fiber][stack_memory]") {
  const size_t bytes = 5 * page_bytes();
  std::mutex mutex;
  std::vector<std::byte*> all;
  const auto work = [&] {
    for (int round = 0; round < 20; ++round) {
      std::vector<std::byte*> mine;
      for (int i = 0; i < 20; ++i) mine.push_back(take_stack(bytes));
      if (round == 19) {
        const std::lock_guard lock(mutex);
        all.insert(all.end(), mine.begin(), mine.end());
      } else {
        for (std::byte* stack : mine) give_back_stack(stack, bytes);
      }
    }
  };
  std::thread first(work), second(work);
  first.join();
  second.join();
  std::sort(all.begin(), all.end());
  REQUIRE(all.size() == 40);
  for (size_t i = 1; i < all.size(); ++i) CHECK(all[i] - all[i - 1] > static_cast<ptrdiff_t>(bytes));
  for (std::byte* stack : all) give_back_stack(stack, bytes);
}

TEST_CASE("more stacks than are kept are given back as well", "[fiber][stack_memory]") {
  const size_t bytes = 64 * 1024 * 1024;
  std::vector<std::byte*> stacks;
  for (int i = 0; i < 64; ++i) stacks.push_back(take_stack(bytes));
  for (std::byte* stack : stacks) give_back_stack(stack, bytes);
  CHECK_NOTHROW(give_back_stack(take_stack(bytes), bytes));
}

TEST_CASE("a fiber whose stack another has left begins anew", "[fiber][stack_memory]") {
  void* last = nullptr;
  for (int round = 0; round < 3; ++round) {
    Fiber fiber(96 * 1024);
    int seen = 0;
    CHECK((last == nullptr || last == &fiber.context()));
    last = &fiber.context();
    struct Both {
      Fiber& fiber;
      int& seen;
    } both{fiber, seen};
    fiber.start(
        [](void* argument) {
          auto& self = *static_cast<Both*>(argument);
          self.seen = 1;
          self.fiber.yield();
          self.seen = 2;
        },
        &both);
    fiber.resume();
    CHECK(seen == 1);
    if (round == 1) continue;  // its stack goes back while it is suspended
    fiber.resume();
    CHECK(seen == 2);
    CHECK(fiber.done());
  }
}
