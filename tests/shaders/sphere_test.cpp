#include <rayloom/shaders/sampler.h>
#include <rayloom/shaders/sphere.h>
#include <rayloom/shaders/warp.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::shaders;

TEST_CASE("a ray meets a sphere where it should") {
  const scenes::Sphere sphere{{1, 2, 3}, 0.5f};
  const auto hit = intersect_sphere(sphere, {1, 2, -7}, {0, 0, 2});
  REQUIRE(hit);
  CHECK(hit->enter == 4.75);
  CHECK(hit->leave == 5.25);
  CHECK_FALSE(intersect_sphere(sphere, {1, 2.6f, -7}, {0, 0, 2}));
  const auto from_inside = intersect_sphere(sphere, {1, 2, 3}, {0, 1, 0});
  REQUIRE(from_inside);
  CHECK(from_inside->enter == -0.5);
  CHECK(from_inside->leave == 0.5);
}

TEST_CASE("hit points lie on the sphere to double precision, also from far away") {
  for (uint32_t i = 0; i < 20000; ++i) {
    Sampler sampler({i, 1}, 0, 1);
    const scenes::Sphere sphere{float3(sampler.next_4d()) * 10.0f, 0.1f + sampler.next_2d().x};
    const float3 origin = sphere.center + 1e4f * uniform_sphere(sampler.next_2d());
    const float3 target = sphere.center + 0.99f * sphere.radius * uniform_sphere(sampler.next_2d());
    const float3 direction = target - origin;
    const auto hit = intersect_sphere(sphere, origin, direction);
    REQUIRE(hit);
    for (const double t : {hit->enter, hit->leave}) {
      const double3 p = double3(origin) + t * double3(direction);
      REQUIRE(glm::length(p - double3(sphere.center)) == Approx(double{sphere.radius}).epsilon(1e-9));
    }
  }
}

TEST_CASE("no direction, or one that is not finite, meets nothing") {
  const scenes::Sphere sphere{{0, 0, 0}, 1};
  CHECK_FALSE(intersect_sphere(sphere, {0, 0, -5}, {0, 0, 0}));
  CHECK_FALSE(intersect_sphere(sphere, {0, 0, -5}, {0, 0, NAN}));
  CHECK_FALSE(intersect_sphere({{0, 0, 0}, NAN}, {0, 0, -5}, {0, 0, 1}));
}

TEST_CASE("boxes enclose their spheres") {
  for (uint32_t i = 0; i < 20000; ++i) {
    Sampler sampler({i, 2}, 0, 1);
    const scenes::Sphere sphere{float3(sampler.next_4d()) * 1e5f, sampler.next_2d().x};
    const RAYTRACING_AABB box = sphere_box(sphere);
    REQUIRE(double{box.MinX} <= double{sphere.center.x} - double{sphere.radius});
    REQUIRE(double{box.MaxX} >= double{sphere.center.x} + double{sphere.radius});
    REQUIRE(double{box.MinZ} <= double{sphere.center.z} - double{sphere.radius});
    REQUIRE(double{box.MaxY} >= double{sphere.center.y} + double{sphere.radius});
  }
}
