#include <rayloom/base/fiber.h>

#include <rayloom/base/float_environment.h>

#include <catch2/catch.hpp>

#include <cstdint>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <vector>

using rayloom::Fiber;

namespace {

/// A fiber that runs a callable; the tests' stand-in for a shader.
template <typename F>
class Running {
 public:
  explicit Running(F body, std::size_t stack_bytes = 256 * 1024) : fiber_(stack_bytes), body_(std::move(body)) {
    start();
  }
  void start() {
    fiber_.start([](void* self) { static_cast<Running*>(self)->run(); }, this);
  }
  Fiber& fiber() { return fiber_; }

 private:
  void run() { body_(fiber_); }
  Fiber fiber_;
  F body_;
};

// Not inlined, with a frame too large for a tail call: what it is for is to use the stack.
[[gnu::noinline]] uint64_t deep_sum(unsigned depth) {
  volatile uint64_t frame[16];
  for (auto& word : frame) word = depth;
  return depth == 0 ? 0 : deep_sum(depth - 1) + frame[depth % 16];
}

}  // namespace

TEST_CASE("a fiber runs until it yields and goes on where it was", "[fiber]") {
  std::vector<int> order;
  Running running([&](Fiber& self) {
    order.push_back(1);
    self.yield();
    order.push_back(3);
  });
  CHECK_FALSE(running.fiber().done());
  running.fiber().resume();
  order.push_back(2);
  CHECK_FALSE(running.fiber().done());
  running.fiber().resume();
  order.push_back(4);
  CHECK(running.fiber().done());
  CHECK(order == std::vector{1, 2, 3, 4});
}

TEST_CASE("thousands of fibers take turns", "[fiber]") {
  constexpr int count = 2000, turns = 20;
  struct Lane {
    Fiber fiber{16 * 1024};
    int turns_done = 0;
  };
  std::vector<Lane> lanes(count);
  for (Lane& lane : lanes) {
    lane.fiber.start(
        [](void* argument) {
          auto& self = *static_cast<Lane*>(argument);
          for (int i = 0; i < turns; ++i) {
            ++self.turns_done;
            self.fiber.yield();
          }
        },
        &lane);
  }
  for (int turn = 1; turn <= turns; ++turn) {
    for (Lane& lane : lanes) lane.fiber.resume();
    for (const Lane& lane : lanes) REQUIRE(lane.turns_done == turn);
  }
  for (Lane& lane : lanes) lane.fiber.resume();
  for (const Lane& lane : lanes) REQUIRE(lane.fiber.done());
}

TEST_CASE("a fiber has the stack it was given", "[fiber]") {
  constexpr unsigned depth = 3000;
  uint64_t sum = 0;
  Running running([&](Fiber&) { sum = deep_sum(depth); }, 4 * 1024 * 1024);
  running.fiber().resume();
  CHECK(running.fiber().done());
  CHECK(sum == uint64_t{depth} * (depth + 1) / 2);
}

TEST_CASE("a finished fiber starts again, with the same or another function", "[fiber]") {
  Fiber fiber;
  int total = 0;
  for (int i = 0; i < 100; ++i) {
    fiber.start([](void* argument) { *static_cast<int*>(argument) += 1; }, &total);
    CHECK_FALSE(fiber.done());
    fiber.resume();
    CHECK(fiber.done());
  }
  fiber.start([](void* argument) { *static_cast<int*>(argument) *= 2; }, &total);
  fiber.resume();
  CHECK(total == 200);
}

TEST_CASE("fibers resume fibers", "[fiber]") {
  std::vector<int> order;
  Running running([&](Fiber& outer) {
    Running inner([&](Fiber& self) {
      order.push_back(2);
      self.yield();
      order.push_back(5);
    });
    order.push_back(1);
    inner.fiber().resume();
    order.push_back(3);
    outer.yield();
    inner.fiber().resume();
    order.push_back(6);
    CHECK(inner.fiber().done());
  });
  running.fiber().resume();
  order.push_back(4);
  running.fiber().resume();
  CHECK(running.fiber().done());
  CHECK(order == std::vector{1, 2, 3, 4, 5, 6});
}

TEST_CASE("a fiber gives its turn to others, which come back to whoever resumed the first", "[fiber]") {
  constexpr int count = 40, rounds = 3;
  struct Ring {
    std::vector<Fiber> fibers;
    std::vector<int> order;
    int next = 0;
  } ring;
  for (std::size_t i = 0; i < count; ++i) ring.fibers.emplace_back(std::size_t{64 * 1024}, i);
  const auto turn = [](void* argument) {
    auto& shared = *static_cast<Ring*>(argument);
    const int own = shared.next;
    volatile double kept = own;
    for (;;) {
      shared.order.push_back(static_cast<int>(kept));
      const bool last = ++shared.next == count;
      Fiber& self = shared.fibers[static_cast<std::size_t>(own)];
      last ? self.yield() : self.yield_to(shared.fibers[static_cast<std::size_t>(own) + 1]);
    }
  };
  for (Fiber& fiber : ring.fibers) fiber.start(turn, &ring);
  for (int round = 0; round < rounds; ++round) {
    ring.next = 0;
    ring.fibers[0].resume();
    CHECK(ring.next == count);
  }
  REQUIRE(ring.order.size() == count * rounds);
  for (int i = 0; i < count * rounds; ++i) CHECK(ring.order[static_cast<std::size_t>(i)] == i % count);
}

TEST_CASE("an exception is thrown and caught inside a fiber", "[fiber]") {
  int caught = 0;
  Running running([&](Fiber& self) {
    for (int i = 0; i < 3; ++i) {
      try {
        if (i != 1) throw std::runtime_error("inside");
      } catch (const std::runtime_error&) {
        ++caught;
      }
      self.yield();
    }
  });
  while (!running.fiber().done()) running.fiber().resume();
  CHECK(caught == 2);
}

TEST_CASE("fibers move while not running, and an unfinished fiber may be destroyed", "[fiber]") {
  static_assert(std::is_nothrow_move_constructible_v<Fiber> && std::is_nothrow_move_assignable_v<Fiber>);
  static_assert(!std::is_copy_constructible_v<Fiber>);
  struct Shared {
    Fiber* fiber;
    int steps = 0;
  } shared{nullptr};
  Fiber first;
  first.start(
      [](void* argument) {
        auto& self = *static_cast<Shared*>(argument);
        for (;;) {
          ++self.steps;
          self.fiber->yield();
        }
      },
      &shared);
  shared.fiber = &first;
  first.resume();
  Fiber second = std::move(first);
  shared.fiber = &second;
  second.resume();
  CHECK(shared.steps == 2);
  CHECK_FALSE(second.done());
}

TEST_CASE("each thread runs fibers of its own", "[fiber]") {
  uint64_t sums[4] = {};
  std::vector<std::thread> threads;
  for (uint64_t& sum : sums) {
    threads.emplace_back([&sum] {
      Running running([&sum](Fiber& self) {
        for (unsigned i = 0; i < 1000; ++i) {
          sum += i;
          self.yield();
        }
      });
      while (!running.fiber().done()) running.fiber().resume();
    });
  }
  for (auto& thread : threads) thread.join();
  for (const uint64_t sum : sums) CHECK(sum == 499'500);
}

#if defined(__x86_64__)
TEST_CASE("a fiber has the fixed float environment and the caller keeps its own", "[fiber]") {
  constexpr unsigned flush_to_zero = 0x8000, round_up = 0x4000;
  const unsigned saved = _mm_getcsr();
  std::vector<unsigned> inside;
  Running running([&](Fiber& self) {
    inside.push_back(_mm_getcsr() & ~0x3Fu);
    _mm_setcsr(rayloom::FloatEnvironment::fixed_mxcsr | round_up);
    self.yield();
    inside.push_back(_mm_getcsr() & ~0x3Fu);
  });
  _mm_setcsr(saved | flush_to_zero);
  running.fiber().resume();
  const unsigned between = _mm_getcsr();
  running.fiber().resume();
  const unsigned after = _mm_getcsr();
  running.start();
  running.fiber().resume();
  _mm_setcsr(saved);
  const auto modes = [](unsigned mxcsr) { return mxcsr & ~0x3Fu; };
  CHECK(modes(between) == modes(saved | flush_to_zero));
  CHECK(modes(after) == modes(saved | flush_to_zero));
  CHECK(inside == std::vector{0x1F80u, 0x1F80u | round_up, 0x1F80u});
}
#endif
