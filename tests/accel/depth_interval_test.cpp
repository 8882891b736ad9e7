// What the depths of vertices tell of a hit's t, against rationals.

#include <rayloom/accel/depth_interval.h>
#include <rayloom/accel/simd/lanes_scalar.h>
#include <rayloom/tests/repetitions.h>

#include <catch2/catch.hpp>
#include <cstdio>

#include "lane_cases.h"
#include "rational_oracle.h"
#include "triangle_cases.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

PreparedRay prepare(const Ray& ray) {
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  return prepare_ray(ray, box[0], box[1]);
}

/// The float nearest to the t at which a ray meets a plane across its dominant axis.
float t_of(const PreparedRay& ray, float coordinate) {
  const uint32_t axis = ray.axis[2];
  return static_cast<float>((double{coordinate} - double{ray.origin[axis]}) / double{ray.direction[axis]});
}

/// Ties aside, which go either way here, the nearest float.
float nearest_float(const mpq_class& exact) {
  float value = static_cast<float>(exact.get_d());
  for (const float other : {std::nextafter(value, -INFINITY), std::nextafter(value, INFINITY)})
    if (!is_nearest(value, exact) && is_nearest(other, exact)) value = other;
  return value;
}

scalar::EdgeFilter filter_of(const Case& c, const PreparedRay& ray, float sign) {
  PlainTriangleLeaf leaf = plain_leaf(1);
  for (int vertex = 0; vertex < 3; ++vertex)
    for (int k = 0; k < 3; ++k) leaf.vertex[k][vertex][0] = c.triangle[vertex][k];
  return scalar::filter_triangle(ray, leaf, 0, sign);
}

/// Limits at, just beside, near and far from a hit's t.
float limit_near(Random& random, float t) {
  switch (random.below(5)) {
    case 0:
      return t;
    case 1:
      return std::nextafter(t, random.chance(2) ? 0.0f : INFINITY);
    case 2:
      return t * (1 + std::ldexp(random.uniform(-1, 1), -static_cast<int>(random.below(24))));
    case 3:
      return INFINITY;
    default:
      return std::fabs(random.scaled(-20, 20));
  }
}

}  // namespace

TEST_CASE("certain hits called outside are outside the interval, those called inside are inside", "[oracle]") {
  int outside = 0, inside = 0, open = 0;
  for (const Family family : all_families) {
    Random random(83 + static_cast<uint64_t>(family));
    for (int i = 0; i < rayloom::test::repetitions(60000); ++i) {
      Case c = random_case(random, family);
      const auto hit = rational_hit(c.ray, c.triangle);
      if (!hit) continue;
      const float t = nearest_float(hit->t);
      c.ray.t_min = random.chance(2) ? 0 : std::fabs(limit_near(random, t));
      const float t_far = std::fabs(limit_near(random, t));
      const PreparedRay ray = prepare(c.ray);
      if (!ray.valid || !(t_far >= ray.t_min)) continue;
      const DepthInterval depths(ray, t_far);
      const scalar::EdgeFilter filter = filter_of(c, ray, depths.sign);
      if (!filter.hit()) continue;
      const auto [is_outside, is_inside, low, most] = scalar::depth_of_hit(filter, depths);
      const bool in_interval = t > ray.t_min && t <= t_far && std::isfinite(t);
      INFO(family_name(family) << " case " << i << ", t " << t << " in " << ray.t_min << " to " << t_far);
      REQUIRE_FALSE((is_outside && in_interval));
      REQUIRE_FALSE((is_inside && !in_interval));
      outside += is_outside;
      inside += is_inside;
      open += !is_outside && !is_inside;
    }
  }
  std::printf("%d certain hits outside, %d inside, %d open\n", outside, inside, open);
  CHECK(outside > rayloom::test::repetitions(5000));
  CHECK(inside > rayloom::test::repetitions(5000));
}

TEST_CASE("no depth beyond the outer limits belongs to a t in the interval, none between the inner ones to another") {
  Random random(81);
  int outside = 0, inside = 0;
  for (int i = 0; i < 400000; ++i) {
    const bool any = random.chance(3);
    Ray given{{}, 0, {}, 0};
    for (int k = 0; k < 3; ++k) {
      given.origin[k] = any ? random.scaled(-140, 120) : random.uniform(-4, 4);
      given.direction[k] = any ? random.scaled(-140, 120) : random.uniform(-1, 1);
    }
    given.t_min = random.chance(2) ? 0 : std::fabs(any ? random.scaled(-140, 120) : random.uniform(0, 2));
    given.t_max = std::numeric_limits<float>::infinity();
    const PreparedRay ray = prepare(given);
    if (!ray.valid) continue;
    const float coordinate = any ? random.scaled(-140, 120) : random.uniform(-8, 8);
    const float t = t_of(ray, coordinate);
    float t_far = t;  // often the limit itself, or its neighbour
    if (random.chance(2)) t_far = std::nextafter(t, random.chance(2) ? 0.0f : given.t_max);
    if (random.chance(3)) t_far = std::fabs(random.uniform(0, 8));
    if (!(t_far > ray.t_min)) continue;
    const DepthInterval depths(ray, t_far);
    const float depth = std::copysign(1.0f, depths.sign) * (coordinate - ray.origin[ray.axis[2]]);
    const bool in_interval = t > ray.t_min && t <= t_far && std::isfinite(t);
    if (in_interval) {
      REQUIRE(depth <= depths.outer_far);
      REQUIRE(depth >= depths.outer_near);
    } else {
      REQUIRE_FALSE((depth > depths.inner_near && depth < depths.inner_far));
    }
    outside += depth > depths.outer_far || depth < depths.outer_near;
    inside += depth > depths.inner_near && depth < depths.inner_far;
  }
  std::printf("%d depths outside, %d inside\n", outside, inside);
  CHECK(outside > 20000);
  CHECK(inside > 15000);  // the absolute margin leaves tiny depths open
}
