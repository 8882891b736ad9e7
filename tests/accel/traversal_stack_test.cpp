#include <rayloom/accel/traverse-inl.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

#include "random.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

struct Case {
  Node8 node{};
  scalar::NodeHits hits;
};

Case random_case(Random& random) {
  Case c;
  for (uint32_t lane = 0; lane < 8; ++lane) {
    c.node.child[lane] = 100 + lane;
    c.hits.near[lane] = static_cast<float>(random.below(4));
  }
  c.hits.mask = 1 + random.below(255);
  return c;
}

template <scalar::Order order>
void check_order(const Case& c, const std::vector<uint32_t>& expected) {
  TraversalStack stack;
  stack.push(7, 0);
  const auto first = scalar::first_child<order>(c.hits, c.node, c.hits.near,
                                                Prefetch{reinterpret_cast<const std::byte*>(&c.node)}, stack);
  for (const uint32_t lane : expected) {
    const auto [ref, distance] = lane == expected.front() ? first : stack.pop();
    REQUIRE(ref == 100 + lane);
    REQUIRE(distance == c.hits.near[lane]);
  }
  REQUIRE(stack.pop().ref == 7);
  REQUIRE(stack.empty());
}

}  // namespace

TEST_CASE("children come nearest first, equals by lane, or from the last stored, over what lay on the stack before") {
  Random random(71);
  for (int i = 0; i < 2000; ++i) {
    const Case c = random_case(random);
    std::vector<uint32_t> lanes;
    for (uint32_t lane = 0; lane < 8; ++lane)
      if (c.hits.mask >> lane & 1) lanes.push_back(lane);
    const std::vector<uint32_t> stored(lanes.rbegin(), lanes.rend());
    std::stable_sort(lanes.begin(), lanes.end(), [&](auto a, auto b) { return c.hits.near[a] < c.hits.near[b]; });
    check_order<scalar::Order::distance>(c, lanes);
    check_order<scalar::Order::stored>(c, stored);
  }
}
