// What the depths of vertices tell of a hit's t, against rationals.

#include <rayloom/accel/depth_interval.h>

#include <catch2/catch.hpp>
#include <cstdio>

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

}  // namespace

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
    const float depth = coordinate - ray.origin[ray.axis[2]];
    const bool in_interval = t > ray.t_min && t <= t_far && std::isfinite(t);
    if (in_interval) {
      REQUIRE(depth <= depths.outer_high);
      REQUIRE(depth >= depths.outer_low);
    } else {
      REQUIRE_FALSE((depth > depths.inner_low && depth < depths.inner_high));
    }
    outside += depth > depths.outer_high || depth < depths.outer_low;
    inside += depth > depths.inner_low && depth < depths.inner_high;
  }
  std::printf("%d depths outside, %d inside\n", outside, inside);
  CHECK(outside > 20000);
  CHECK(inside > 20000);
}
