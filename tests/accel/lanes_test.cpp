// Every SIMD target against the scalar lanes, bit for bit; compiled per target as accel/simd/kernel_highway.cpp is.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/tests/accel/lanes_test.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <hwy/highway.h>

#include <rayloom/accel/simd/children-inl.h>
#include <rayloom/accel/simd/lane_hit-inl.h>
#include <rayloom/accel/simd/prepare-inl.h>

#ifndef RAYLOOM_TESTS_ACCEL_LANES_TEST
#define RAYLOOM_TESTS_ACCEL_LANES_TEST

#include "lane_cases.h"
#include "targets.h"

namespace rayloom::accel {

/// The functions of one target.
struct LaneFunctions {
  uint32_t (*node)(const PreparedRay&, const Node8&, float t_near, float t_far, float near_out[8]);
  uint32_t (*boxes)(const PreparedRay&, const ProceduralLeaf8&, float t_near, float t_far);
  LeafMasks (*triangles)(const PreparedRay&, const TriangleLeaf&, float t_far);
  void (*prepare)(const Ray&, const StructureHeader&, float pad_scale, PreparedRay&);
  void (*object_ray)(const InstanceRecord&, const Ray&, Ray&);
  void (*push)(const PreparedRay&, const Node8&, float t_near, float t_far, bool by_distance, TraversalStack&);
  TraversalStack::Entry (*nearest)(const PreparedRay&, const Node8&, float t_near, float t_far);
  void (*drop)(TraversalStack&, uint32_t base, float t_far);
  LeafMasks (*depths)(const PreparedRay&, const TriangleLeaf&, float t_far, float outer_far, float nearest[8],
                      uint32_t& beyond);
  std::optional<TriangleHit> (*hit)(const PreparedRay&, const TriangleLeaf&, uint32_t lane, float t_far);
  void (*determinants)(const PreparedRay&, const TriangleLeaf&, uint32_t lane, double value[4], double error[4]);
};

}  // namespace rayloom::accel

#endif

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

uint32_t run_node(const PreparedRay& ray, const Node8& node, float t_near, float t_far, float near_out[8]) {
  const NodeHits hits = test_node(BoxLanes(ray), node, t_near, t_far);
  float near[8];
  hits.store_near(near);
  std::copy_n(near, 8, near_out);
  return hits.mask;
}

uint32_t run_boxes(const PreparedRay& ray, const ProceduralLeaf8& leaf, float t_near, float t_far) {
  return test_boxes(BoxLanes(ray), leaf, t_near, t_far);
}

LeafMasks run_triangles(const PreparedRay& ray, const TriangleLeaf& leaf, float t_far) {
  return test_triangles(TriangleLanes(ray), leaf, DepthInterval(ray, t_far));
}

void run_prepare(const Ray& ray, const StructureHeader& header, float pad_scale, PreparedRay& out) {
  prepare_lanes(ray, BoundsLanes(header, pad_scale), out);
}

void run_object_ray(const InstanceRecord& instance, const Ray& ray, Ray& out) { object_ray_lanes(instance, ray, out); }

void run_push(const PreparedRay& ray, const Node8& node, float t_near, float t_far, bool by_distance,
              TraversalStack& stack) {
  const NodeHits hits = test_node(BoxLanes(ray), node, t_near, t_far);
  by_distance ? push_by_distance(hits, node, stack) : push_in_order(hits, node, stack);
}

TraversalStack::Entry run_nearest(const PreparedRay& ray, const Node8& node, float t_near, float t_far) {
  return nearest_child(test_node(BoxLanes(ray), node, t_near, t_far), node);
}

LeafMasks run_depths(const PreparedRay& ray, const TriangleLeaf& leaf, float t_far, float outer_far, float out[8],
                     uint32_t& beyond) {
  LeafDepths depths;
  const LeafMasks masks = test_triangles(TriangleLanes(ray), leaf, DepthInterval(ray, t_far), depths);
  float nearest[8];
  store_nearest(depths, nearest);
  std::copy_n(nearest, 8, out);
  beyond = depths_beyond(depths, outer_far);
  return masks;
}

void run_drop(TraversalStack& stack, uint32_t base, float t_far) { drop_farther(stack, base, t_far); }

std::optional<TriangleHit> run_hit(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane, float t_far) {
  return hit_lane(ray, leaf, lane, t_far);
}

void run_determinants(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane, double value[4],
                      double error[4]) {
  const LaneDeterminants determinants(ray, leaf, lane);
  hn::StoreU(determinants.value, WideAxes(), value);
  hn::StoreU(determinants.error, WideAxes(), error);
}

LaneFunctions lane_functions() {
  return {run_node,    run_boxes, run_triangles, run_prepare, run_object_ray,  run_push,
          run_nearest, run_drop,  run_depths,    run_hit,     run_determinants};
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <rayloom/accel/simd/children_scalar.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

namespace rayloom::accel {
namespace {

using test::Random;

std::vector<test::Target<LaneFunctions>> targets() {
  return test::supported_targets(N_AVX2::lane_functions(), N_AVX3::lane_functions());
}

bool same_bits(const float (&a)[8], const float (&b)[8]) { return std::memcmp(a, b, sizeof(a)) == 0; }

TEST_CASE("node tests give the same bits on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(21);
    int visited = 0;
    for (int i = 0; i < 200000; ++i) {
      const test::NodeCase c = test::random_node_case(random);
      if (!c.ray.valid) continue;
      float near[8];
      const float t_near = c.ray.near_limit(c.ray.t_min), t_far = c.ray.far_limit(c.ray.t_max);
      const scalar::NodeHits expected = scalar::test_node(scalar::BoxLanes(c.ray), c.node, t_near, t_far);
      INFO(isa_name(target.isa) << ", case " << i);
      REQUIRE(target.functions.node(c.ray, c.node, t_near, t_far, near) == expected.mask);
      REQUIRE(same_bits(near, expected.near));
      REQUIRE((expected.mask & c.empty_lanes) == 0);
      visited += std::popcount(expected.mask);
    }
    std::printf("%s: %d boxes entered\n", isa_name(target.isa).data(), visited);
    CHECK(visited > 100000);
  }
}

size_t bytes_before_valid(const PreparedRay& ray) {
  return static_cast<size_t>(reinterpret_cast<const char*>(&ray.valid) - reinterpret_cast<const char*>(&ray));
}

TEST_CASE("rays are prepared with the same bits on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(25);
    for (int i = 0; i < 100000; ++i) {
      const uint32_t style = random.below(4);
      StructureHeader header{};
      for (int k = 0; k < 3; ++k) {
        const float a = test::any_coordinate(random, style), b = test::any_coordinate(random, style);
        header.bounds_min[k] = std::min(a, b);
        header.bounds_max[k] = std::max(a, b);
      }
      header.node_count = 1 + random.below(1000);  // lies behind the bounds
      const Ray ray = test::any_ray(random, style);
      const float pad_scale = random.chance(2) ? 1.0f : 1 + std::fabs(random.scaled(0, 30));
      PreparedRay expected{}, found{};
      scalar::prepare_lanes(ray, scalar::BoundsLanes(header, pad_scale), expected);
      target.functions.prepare(ray, header, pad_scale, found);
      REQUIRE(found.valid == expected.valid);
      if (!found.valid) continue;
      for (PreparedRay* out : {&expected, &found}) {  // the fourth elements hold no meaning
        out->reciprocal[3] = out->near_offset[3] = out->far_offset[3] = 0;
        out->near_row[3] = 0;
      }
      INFO(isa_name(target.isa) << ", case " << i);
      REQUIRE(std::memcmp(&expected, &found, bytes_before_valid(found)) == 0);
    }
  }
}

TEST_CASE("rays are taken to object space with the same bits on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(28);
    for (int i = 0; i < 100000; ++i) {
      const uint32_t style = random.below(4);
      InstanceRecord instance{};
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) {
          instance.world_to_object[row][column] = double{test::any_coordinate(random, style)} / 3;
          instance.object_to_world[row][column] = test::any_coordinate(random, style);
        }
      const Ray ray = test::any_ray(random, style), expected = object_ray(instance, ray);
      Ray found{};
      target.functions.object_ray(instance, ray, found);
      INFO(isa_name(target.isa) << ", case " << i);
      REQUIRE(std::memcmp(&expected, &found, sizeof(Ray)) == 0);
    }
  }
}

/// A stack whose lower entries must survive.
void fill(TraversalStack& stack, Random random) {
  const uint32_t count = 1 + random.below(40);
  for (uint32_t i = 0; i < count; ++i) stack.push(1000 + i, static_cast<float>(random.below(10)));
}

void require_equal(TraversalStack& a, TraversalStack& b, uint32_t nears_from = 0) {
  REQUIRE(a.size() == b.size());
  REQUIRE(std::equal(a.refs(), a.refs() + a.size(), b.refs()));
  if (nears_from < a.size()) REQUIRE(std::equal(a.nears() + nears_from, a.nears() + a.size(), b.nears() + nears_from));
}

TEST_CASE("children go on the stack in the same order on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(24);
    int many = 0;
    for (int i = 0; i < 50000; ++i) {
      test::NodeCase c = test::random_node_case(random);
      if (!c.ray.valid) continue;
      if (random.chance(2))  // equal distances
        for (int k = 0; k < 3; ++k)
          for (int side = 0; side < 2; ++side) std::fill_n(c.node.bounds[k][side], 8, c.node.bounds[k][side][0]);
      for (uint32_t lane = 0; lane < 8; ++lane) c.node.child[lane] = 100 + lane;
      const float t_near = c.ray.near_limit(c.ray.t_min), t_far = c.ray.far_limit(c.ray.t_max);
      TraversalStack expected, found;
      fill(expected, random), fill(found, random);
      const uint32_t below = expected.size();
      const scalar::NodeHits hits = scalar::test_node(scalar::BoxLanes(c.ray), c.node, t_near, t_far);
      const bool by_distance = random.chance(2);
      by_distance ? scalar::push_by_distance(hits, c.node, expected) : scalar::push_in_order(hits, c.node, expected);
      target.functions.push(c.ray, c.node, t_near, t_far, by_distance, found);
      INFO(isa_name(target.isa) << ", case " << i);
      require_equal(expected, found, by_distance ? 0 : expected.size());
      REQUIRE(std::equal(expected.nears(), expected.nears() + below, found.nears()));
      many += std::popcount(hits.mask) > 4;
      if (!by_distance || hits.mask == 0) continue;
      for (const auto& nearest :
           {scalar::nearest_child(hits, c.node), target.functions.nearest(c.ray, c.node, t_near, t_far)}) {
        REQUIRE(nearest.ref == expected.refs()[expected.size() - 1]);
        REQUIRE(nearest.near == expected.nears()[expected.size() - 1]);
      }
    }
    CHECK(many > 1000);
  }
}

TEST_CASE("entries beyond the closest hit leave the stack on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(26);
    for (int i = 0; i < 20000; ++i) {
      TraversalStack expected, found;
      fill(expected, random), fill(found, random);
      const uint32_t base = random.below(expected.size() + 1);
      const auto t_far = static_cast<float>(random.below(10));
      scalar::drop_farther(expected, base, t_far);
      target.functions.drop(found, base, t_far);
      require_equal(expected, found);
    }
  }
}

TEST_CASE("procedural box tests give the same bits on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(22);
    for (int i = 0; i < 100000; ++i) {
      const test::NodeCase c = test::random_node_case(random);
      if (!c.ray.valid) continue;
      ProceduralLeaf8 leaf;
      std::memcpy(leaf.bounds, c.node.bounds, sizeof(leaf.bounds));
      for (uint32_t lane = 0; lane < 8; ++lane) leaf.primitive[lane] = c.empty_lanes >> lane & 1 ? no_index : lane;
      const float t_near = c.ray.near_limit(c.ray.t_min), t_far = c.ray.far_limit(c.ray.t_max);
      const uint32_t expected = scalar::test_boxes(scalar::BoxLanes(c.ray), leaf, t_near, t_far);
      REQUIRE(target.functions.boxes(c.ray, leaf, t_near, t_far) == expected);
      REQUIRE((expected & c.empty_lanes) == 0);
    }
  }
}

TEST_CASE("triangle filters give the same masks on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(23);
    int certain = 0, undecided = 0;
    for (int i = 0; i < 100000; ++i) {
      const test::LeafCase c = test::random_leaf_case(random);
      const float t_far = random.chance(2) ? c.ray.t_max : std::fabs(random.scaled(-10, 10));
      const DepthInterval depths(c.ray, t_far);
      const LeafMasks expected = scalar::test_triangles(scalar::TriangleLanes(c.ray), c.leaf, depths);
      const LeafMasks masks = target.functions.triangles(c.ray, c.leaf, t_far);
      INFO(isa_name(target.isa) << ", case " << i);
      REQUIRE(masks.possible == expected.possible);
      REQUIRE(masks.certain == expected.certain);
      REQUIRE(masks.inside == expected.inside);
      REQUIRE((masks.certain & ~masks.possible) == 0);
      REQUIRE((masks.possible & c.unused_lanes) == 0);
      certain += std::popcount(masks.certain);
      undecided += std::popcount(masks.possible & ~masks.certain);
    }
    std::printf("%s: %d lanes certain, %d undecided\n", isa_name(target.isa).data(), certain, undecided);
    CHECK(certain > 10000);
    CHECK(undecided > 10000);
  }
}

TEST_CASE("which certain hits come first and which lie beyond a depth is the same on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(34);
    int several = 0, dropped = 0;
    for (int i = 0; i < 100000; ++i) {
      const test::LeafCase c = test::random_leaf_case(random);
      const DepthInterval depths(c.ray, c.ray.t_max);
      scalar::LeafDepths found;
      const LeafMasks expected = scalar::test_triangles(scalar::TriangleLanes(c.ray), c.leaf, depths, found);
      float wanted[8], nearest[8];
      scalar::store_nearest(found, wanted);
      const float outer_far = wanted[random.below(8)] * random.uniform(0.5f, 2);
      uint32_t beyond;
      const LeafMasks masks = target.functions.depths(c.ray, c.leaf, c.ray.t_max, outer_far, nearest, beyond);
      INFO(isa_name(target.isa) << ", case " << i);
      REQUIRE(masks.certain == expected.certain);
      REQUIRE((beyond & masks.certain) == (scalar::depths_beyond(found, outer_far) & masks.certain));
      for (uint32_t left = masks.certain; left != 0; left &= left - 1) {
        const float a = nearest[std::countr_zero(left)], b = wanted[std::countr_zero(left)];
        REQUIRE((a == b || (std::isnan(a) && std::isnan(b))));
      }
      several += std::popcount(masks.certain) > 1;
      dropped += std::popcount(beyond & masks.certain);
    }
    CHECK(several > 1000);
    CHECK(dropped > 1000);
  }
}

TEST_CASE("certain hits have the same bits on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(29);
    int hits = 0, outside = 0;
    for (int i = 0; i < 100000; ++i) {
      const test::LeafCase c = test::random_leaf_case(random);
      const float t_far = random.chance(2) ? c.ray.t_max : std::fabs(random.scaled(-10, 10));
      for (uint32_t left = target.functions.triangles(c.ray, c.leaf, c.ray.t_max).certain; left != 0;
           left &= left - 1) {
        const auto lane = static_cast<uint32_t>(std::countr_zero(left));
        const auto expected = scalar::hit_lane(c.ray, c.leaf, lane, t_far);
        const auto hit = target.functions.hit(c.ray, c.leaf, lane, t_far);
        INFO(isa_name(target.isa) << ", case " << i << ", lane " << lane);
        REQUIRE(hit.has_value() == expected.has_value());
        outside += !hit;
        if (!hit) continue;
        ++hits;
        const float found[] = {hit->t, hit->u, hit->v}, wanted[] = {expected->t, expected->u, expected->v};
        REQUIRE(std::memcmp(found, wanted, sizeof found) == 0);
        REQUIRE(hit->front == expected->front);
      }
    }
    CHECK(hits > 10000);
    CHECK(outside > 1000);
  }
}

/// The bounds of docs/numerics.md, 2.2, on the errors of t's, u's, v's and the area's determinant, with what covers the
/// division.
std::array<double, 4> proved_errors(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane,
                                    const double (&value)[4]) {
  double edge1 = 0, edge2 = 0, point = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const double v0 = leaf.coordinate(0, k, lane);
    edge1 += std::fabs(double{leaf.coordinate(1, k, lane)} - v0);
    edge2 += std::fabs(double{leaf.coordinate(2, k, lane)} - v0);
    point += std::fabs(v0 - double{ray.origin[k]});
  }
  const double reach = point + edge1 + edge2, depth = std::fabs(double{ray.direction[ray.axis[2]]});
  const double rounding = 8 * 0x1p-53, division = std::fabs(value[3]);
  return {rounding * (3 * edge1 * edge2 * reach + std::fabs(value[0])), rounding * (edge2 * reach * depth + division),
          rounding * (edge1 * reach * depth + division), rounding * (edge1 * edge2 * depth + division)};
}

TEST_CASE("errors of a certain hit's determinants are allowed for as the proof demands", "[unit]") {
  for (const auto& target : targets()) {
    Random random(33);
    int lanes = 0;
    for (int i = 0; i < 20000; ++i) {
      const test::LeafCase c = test::random_leaf_case(random);
      for (uint32_t left = target.functions.triangles(c.ray, c.leaf, c.ray.t_max).certain; left != 0;
           left &= left - 1) {
        const auto lane = static_cast<uint32_t>(std::countr_zero(left));
        double value[4], error[4];
        target.functions.determinants(c.ray, c.leaf, lane, value, error);
        const std::array<double, 4> proved = proved_errors(c.ray, c.leaf, lane, value);
        INFO(isa_name(target.isa) << ", case " << i << ", lane " << lane);
        for (int k = 0; k < 4; ++k) REQUIRE(std::fabs(error[k] - proved[k]) <= 1e-14 * proved[k]);
        ++lanes;
      }
    }
    CHECK(lanes > 2000);
  }
}

TEST_CASE("vertex tables are looked up in the same way on every target", "[unit]") {
  for (const auto& target : targets()) {
    Random random(27);
    int certain = 0;
    for (int i = 0; i < 100000; ++i) {
      test::TableLeafCase c = test::random_table_leaf_case(random);
      const float t_far = random.chance(2) ? c.ray.t_max : std::fabs(random.scaled(-10, 10));
      const DepthInterval depths(c.ray, t_far);
      const LeafMasks expected = scalar::test_triangles(scalar::TriangleLanes(c.ray), c.leaf(), depths);
      const LeafMasks masks = target.functions.triangles(c.ray, c.leaf(), t_far);
      INFO(isa_name(target.isa) << ", case " << i);
      REQUIRE(masks.possible == expected.possible);
      REQUIRE(masks.certain == expected.certain);
      REQUIRE(masks.inside == expected.inside);
      certain += std::popcount(masks.certain);
    }
    CHECK(certain > 1000);
  }
}

}  // namespace
}  // namespace rayloom::accel

#endif  // HWY_ONCE
