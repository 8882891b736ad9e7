#include <rayloom/accel/kept_array.h>

#include <catch2/catch.hpp>

#include <cstdint>
#include <memory>
#include <thread>

using namespace rayloom::accel;

TEST_CASE("a thread's kept arrays of a type use the same memory one after another, and nested ones their own") {
  struct alignas(64) Element {
    uint64_t value;
  };
  const Element* first = nullptr;
  {
    KeptArray<Element> outer(8);
    first = outer.begin();
    CHECK(reinterpret_cast<uintptr_t>(first) % 64 == 0);
    KeptArray<Element> inner(4);
    CHECK(inner.begin() != first);
    const Element* other = nullptr;
    std::thread([&] { other = KeptArray<Element>(8).begin(); }).join();
    CHECK(other != first);
  }
  CHECK(KeptArray<Element>(5).begin() == first);
  KeptArray<Element> larger(100);
  for (uint64_t i = 0; i < 100; ++i) larger.emplace_back(i);
  CHECK(larger.end() - larger.begin() == 100);
  CHECK(larger[99].value == 99);
}

TEST_CASE("the larger memory of two is what a thread keeps") {
  struct Element {
    uint32_t value[4];
  };
  const Element* large = nullptr;
  {
    KeptArray<Element> outer(4);
    KeptArray<Element> inner(1000);
    large = inner.begin();
  }
  CHECK(KeptArray<Element>(1000).begin() == large);
}

TEST_CASE("elements of kept arrays live from when they are added to when the array is cleared or ends") {
  const auto alive = std::make_shared<int>();
  {
    KeptArray<std::shared_ptr<int>> array(3);
    CHECK(array.empty());
    array.emplace_back(alive);
    array.emplace_back(alive);
    CHECK(alive.use_count() == 3);
    array.clear();
    CHECK(alive.use_count() == 1);
    array.emplace_back(alive);
    CHECK(array.size() == 1);
  }
  CHECK(alive.use_count() == 1);
}
