#include <rayloom/accel/traverse-inl.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

#include "random.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

TEST_CASE("children come nearest first, equals by lane, or in stored order, over what lay on the stack before") {
  Random random(71);
  for (int i = 0; i < 2000; ++i) {
    Node8 node{};
    float near[8];
    for (uint32_t lane = 0; lane < 8; ++lane) {
      node.child[lane] = 100 + lane;
      near[lane] = static_cast<float>(random.below(4));
    }
    const uint32_t mask = 1 + random.below(255);
    TraversalStack stack;
    stack.push(7, 0);
    const bool sorted = random.chance(2);
    const scalar::Child first =
        scalar::first_child(node, mask, near, !sorted, Prefetch{reinterpret_cast<const std::byte*>(&node)}, stack);

    std::vector<uint32_t> expected;
    for (uint32_t lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1) expected.push_back(lane);
    if (sorted) std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return near[a] < near[b]; });
    for (const uint32_t lane : expected) {
      const auto [ref, distance] = lane == expected.front() ? first : stack.pop();
      REQUIRE(ref == 100 + lane);
      REQUIRE(distance == near[lane]);
    }
    REQUIRE(stack.pop().ref == 7);
    REQUIRE(stack.empty());
  }
}
