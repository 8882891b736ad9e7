// Every SIMD target against the scalar lanes, bit for bit; compiled per target as accel/simd/kernel_highway.cpp is.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/tests/accel/lanes_test.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <hwy/highway.h>

#include <rayloom/accel/simd/lanes-inl.h>

#ifndef RAYLOOM_TESTS_ACCEL_LANES_TEST
#define RAYLOOM_TESTS_ACCEL_LANES_TEST

#include "lane_cases.h"

namespace rayloom::accel {

/// The functions of one target.
struct LaneFunctions {
  uint32_t (*node)(const PreparedRay&, const Node8&, float t_near, float t_far, float near_out[8]);
  uint32_t (*boxes)(const PreparedRay&, const ProceduralLeaf8&, float t_near, float t_far);
  LeafMasks (*triangles)(const PreparedRay&, const TriangleLeaf8&);
  uint32_t (*before)(const float near[8], int lane);
};

}  // namespace rayloom::accel

#endif

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

uint32_t run_node(const PreparedRay& ray, const Node8& node, float t_near, float t_far, float near_out[8]) {
  return test_node(RayLanes(ray), node, t_near, t_far, near_out);
}

uint32_t run_boxes(const PreparedRay& ray, const ProceduralLeaf8& leaf, float t_near, float t_far) {
  return test_boxes(RayLanes(ray), leaf, t_near, t_far);
}

LeafMasks run_triangles(const PreparedRay& ray, const TriangleLeaf8& leaf) {
  return test_triangles(RayLanes(ray), leaf);
}

uint32_t run_before(const float near[8], int lane) { return lanes_before(near, lane); }

LaneFunctions lane_functions() { return {run_node, run_boxes, run_triangles, run_before}; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <rayloom/accel/simd/lanes_scalar.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstring>
#include <vector>

namespace rayloom::accel {
namespace {

using test::Random;

struct Target {
  const char* name;
  LaneFunctions functions;
};

std::vector<Target> supported_targets() {
  std::vector<Target> targets;
  if (hwy::SupportedTargets() & HWY_AVX2) targets.push_back({"AVX2", N_AVX2::lane_functions()});
  if (hwy::SupportedTargets() & HWY_AVX3) targets.push_back({"AVX-512", N_AVX3::lane_functions()});
  return targets;
}

bool same_bits(const float (&a)[8], const float (&b)[8]) { return std::memcmp(a, b, sizeof(a)) == 0; }

TEST_CASE("node tests give the same bits on every target", "[unit]") {
  for (const Target& target : supported_targets()) {
    Random random(21);
    int visited = 0;
    for (int i = 0; i < 200000; ++i) {
      const test::NodeCase c = test::random_node_case(random);
      if (!c.ray.valid) continue;
      alignas(32) float expected_near[8], near[8];
      const float t_near = c.ray.near_limit(c.ray.t_min), t_far = c.ray.far_limit(c.ray.t_max);
      const uint32_t expected = scalar::test_node(scalar::RayLanes(c.ray), c.node, t_near, t_far, expected_near);
      INFO(target.name << ", case " << i);
      REQUIRE(target.functions.node(c.ray, c.node, t_near, t_far, near) == expected);
      REQUIRE(same_bits(near, expected_near));
      REQUIRE((expected & c.empty_lanes) == 0);
      visited += std::popcount(expected);
    }
    std::printf("%s: %d boxes entered\n", target.name, visited);
    CHECK(visited > 100000);
  }
}

TEST_CASE("lanes are ordered in the same way on every target", "[unit]") {
  for (const Target& target : supported_targets()) {
    Random random(24);
    for (int i = 0; i < 20000; ++i) {
      float near[8];
      for (float& distance : near) distance = static_cast<float>(random.below(4));
      const auto lane = static_cast<int>(random.below(8));
      REQUIRE(target.functions.before(near, lane) == scalar::lanes_before(near, lane));
    }
  }
}

TEST_CASE("procedural box tests give the same bits on every target", "[unit]") {
  for (const Target& target : supported_targets()) {
    Random random(22);
    for (int i = 0; i < 100000; ++i) {
      const test::NodeCase c = test::random_node_case(random);
      if (!c.ray.valid) continue;
      ProceduralLeaf8 leaf;
      std::memcpy(leaf.bounds, c.node.bounds, sizeof(leaf.bounds));
      for (uint32_t lane = 0; lane < 8; ++lane) leaf.primitive[lane] = c.empty_lanes >> lane & 1 ? no_index : lane;
      const float t_near = c.ray.near_limit(c.ray.t_min), t_far = c.ray.far_limit(c.ray.t_max);
      const uint32_t expected = scalar::test_boxes(scalar::RayLanes(c.ray), leaf, t_near, t_far);
      REQUIRE(target.functions.boxes(c.ray, leaf, t_near, t_far) == expected);
      REQUIRE((expected & c.empty_lanes) == 0);
    }
  }
}

TEST_CASE("triangle filters give the same masks on every target", "[unit]") {
  for (const Target& target : supported_targets()) {
    Random random(23);
    int certain = 0, undecided = 0;
    for (int i = 0; i < 100000; ++i) {
      const test::LeafCase c = test::random_leaf_case(random);
      const LeafMasks expected = scalar::test_triangles(scalar::RayLanes(c.ray), c.leaf);
      const LeafMasks masks = target.functions.triangles(c.ray, c.leaf);
      INFO(target.name << ", case " << i);
      REQUIRE(masks.possible == expected.possible);
      REQUIRE(masks.certain == expected.certain);
      REQUIRE((masks.certain & ~masks.possible) == 0);
      REQUIRE((masks.possible & c.unused_lanes) == 0);
      certain += std::popcount(masks.certain);
      undecided += std::popcount(masks.possible & ~masks.certain);
    }
    std::printf("%s: %d lanes certain, %d undecided\n", target.name, certain, undecided);
    CHECK(certain > 10000);
    CHECK(undecided > 10000);
  }
}

}  // namespace
}  // namespace rayloom::accel

#endif  // HWY_ONCE
