// Closed meshes and rays aimed at their edges and vertices (FF-01 to FF-03, FF-08; guarantee G1). A mesh that is closed
// needs no geometric oracle: from inside an odd number of triangles is hit, from outside an even one, and a convex one
// exactly once.

#include <catch2/catch.hpp>

#include "random.h"
#include "recorder.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

struct Count {
  size_t rays = 0, leaks = 0, wrong_parity = 0, doubles = 0, closest_differs = 0;
};

/// Counts what one ray meets, by rejecting every candidate, and compares with the closest hit.
void count(const Block& block, const Ray& ray, bool inside, Count& result) {
  Recorder recorder;
  trace({}, recorder.request(block, ray));
  const size_t hits = recorder.candidates.size();
  const Hit closest = trace({}, request_for(block, ray));
  ++result.rays;
  result.leaks += inside && hits == 0;
  result.doubles += inside && hits > 1;
  result.wrong_parity += hits % 2 != (inside ? 1 : 0);
  result.closest_differs += bool(closest) != (hits > 0);
}

/// A point of the mesh that several triangles share, or nearly: a vertex or a point of an edge, jittered by ulps.
Point target(const Mesh& mesh, Random& random) {
  const auto& triangle = mesh.triangles[random.below(uint32_t(mesh.triangles.size()))];
  const uint32_t corner = random.below(3);
  Point p = mesh.vertices[triangle[corner]];
  if (random.chance(2)) {
    const Point& q = mesh.vertices[triangle[(corner + 1) % 3]];
    const float weight = random.chance(4) ? 0.5f : random.uniform(0, 1);
    for (int k = 0; k < 3; ++k) p[k] += weight * (q[k] - p[k]);
  }
  if (random.chance(2))
    for (float& x : p) x = random.nudged(x, 4);
  return p;
}

Count shoot(const Mesh& mesh, const Point& origin, bool inside, size_t rays, uint64_t seed) {
  const Block block = build_mesh(mesh, geometry_flag::none);
  Random random(seed);
  Count result;
  for (size_t i = 0; i < rays; ++i) count(block, ray_between(origin, target(mesh, random)), inside, result);
  return result;
}

void check_closed(const Mesh& mesh, const Point& inside, const Point& outside, size_t rays, bool convex) {
  for_each_isa([&](Isa isa) {
    REQUIRE(current_isa() == isa);
    const Count in = shoot(mesh, inside, true, rays, 11), out = shoot(mesh, outside, false, rays, 12);
    CHECK(in.rays == rays);
    CHECK(in.leaks == 0);
    CHECK(in.wrong_parity == 0);
    CHECK(in.closest_differs == 0);
    CHECK(out.wrong_parity == 0);
    CHECK(out.closest_differs == 0);
    if (convex) CHECK(in.doubles == 0);
  });
}

}  // namespace

TEST_CASE("closed meshes have no leak and no double hit at any scale") {
  const Mesh sphere = icosphere(3), box = cube(3), bumps = bumpy_sphere(3), ring = torus(40, 24, 0.375f);
  for (const int exponent : {-120, -100, -60, -30, -7, 0, 7, 30, 60, 100}) {
    const float scale = std::ldexp(1.0f, exponent);
    CAPTURE(exponent);
    const auto at = [&](float x, float y, float z) { return Point{x * scale, y * scale, z * scale}; };
    check_closed(moved(sphere, scale, 0), at(0.1f, -0.2f, 0.3f), at(3, 0.5f, -2), 1000, true);
    check_closed(moved(box, scale, 0), at(0.1f, 0.5f, 0.25f), at(-3, 0.5f, 2), 1000, true);
    check_closed(moved(bumps, scale, 0), at(0, 0, 0), at(2, 2, 2), 500, false);
    check_closed(moved(ring, scale, 0), at(1, 0.0625f, 0), at(0, 0, 0), 500, false);
  }
}

TEST_CASE("closed meshes have no leak far from the origin") {
  const Mesh sphere = icosphere(3), box = cube(3), ring = torus(40, 24, 0.375f);
  for (const float offset : {10.f, 1000.f, 31415.9f, 148376.f, 1e6f}) {
    CAPTURE(offset);
    const auto at = [&](float x, float y, float z) { return Point{offset + x, offset + y, offset + z}; };
    check_closed(moved(sphere, 1, offset), at(0, 0, 0), at(30, 5, -20), 1000, false);
    check_closed(moved(box, 1, offset), at(0.5f, 0, 0.25f), at(-30, 5, 20), 1000, true);
    check_closed(moved(ring, 1, offset), at(1, 0, 0), at(0, 0, 0), 1000, false);
  }
}

TEST_CASE("origins on a grid and axis-parallel rays through a cube's edges and vertices") {
  const Mesh box = cube(2);  // vertices at multiples of 1/2
  const Block block = build_mesh(box, geometry_flag::none);
  for_each_isa([&](Isa) {
    Count inside, outside;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = -1; side <= 1; side += 2)
        for (int i = -3; i <= 3; ++i)
          for (int j = -3; j <= 3; ++j)
            for (const float zero : {0.0f, -0.0f}) {
              Ray ray{{}, 0, {zero, zero, zero}, Box::infinity};
              ray.origin[(axis + 1) % 3] = 0.25f * static_cast<float>(i);
              ray.origin[(axis + 2) % 3] = 0.25f * static_cast<float>(j);
              ray.direction[axis] = static_cast<float>(side);
              count(block, ray, true, inside);
              ray.origin[axis] = -2 * ray.direction[axis];
              count(block, ray, false, outside);
            }
    CHECK(inside.leaks + inside.doubles + inside.wrong_parity + inside.closest_differs == 0);
    CHECK(outside.wrong_parity + outside.closest_differs == 0);
  });
}

TEST_CASE("long ridges grazed by rays lose no box (numerics K13)") {
  Random random(13);
  for (const float length : {10.f, 1e3f, 1e6f}) {
    Mesh ridge;  // a long closed wedge
    for (const Point& p :
         {Point{-length, 0, -1}, {-length, 0, 1}, {-length, 1, 0}, {length, 0, -1}, {length, 0, 1}, {length, 1, 0}})
      ridge.add(p);
    ridge.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 2, 5}, {0, 5, 3}, {1, 4, 5}, {1, 5, 2}, {0, 3, 4}, {0, 4, 1}};
    for (int i = 0; i < 3; ++i) ridge = subdivided(ridge, [](const Point& p) { return p; });
    const Block block = build_mesh(ridge, geometry_flag::none);
    for_each_isa([&](Isa) {
      Count inside;
      for (int i = 0; i < 1000; ++i) {
        const Point origin{random.uniform(-1, 1), 1 - 1e-4f, random.uniform(-1e-5f, 1e-5f)};
        const Point along{random.chance(2) ? length : -length, 1, 0};
        count(block, ray_between(origin, along), true, inside);
      }
      CHECK(inside.leaks + inside.wrong_parity + inside.closest_differs == 0);
    });
  }
}
