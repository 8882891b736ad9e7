#include <rayloom/accel/close_box.h>
#include <rayloom/accel/instance_transform.h>

#include <catch2/catch.hpp>

#include <iterator>

#include "random.h"
#include "structures.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

Box bounds_of(const Block& block) {
  Box box;
  box.extend(block.header().bounds_min, block.header().bounds_max);
  return box;
}

bool lies_within(const Box& inner, const Box& outer) {
  for (int k = 0; k < 3; ++k) {
    if (!(outer.min[k] <= inner.min[k] && inner.max[k] <= outer.max[k])) return false;
  }
  return true;
}

bool same(const Box& a, const Box& b) { return lies_within(a, b) && lies_within(b, a); }

/// Whether it holds a point's image, with what rounding object-space rays needs (prepare_ray()).
bool holds(const Box& box, const Matrix& m, const Point& p) {
  for (int row = 0; row < 3; ++row) {
    long double x = m[row][3], size = 0;
    for (int k = 0; k < 3; ++k) x += static_cast<long double>(m[row][k]) * p[k];
    for (int k = 0; k < 3; ++k) size = std::max(size, static_cast<long double>(std::fabs(p[k])));
    long double norm = 0;
    for (const auto& of : m) norm = std::max<long double>(norm, std::fabs(of[0]) + std::fabs(of[1]) + std::fabs(of[2]));
    const long double margin = 0x1p-22L * norm * size;
    if (!(box.min[row] <= x - margin && x + margin <= box.max[row])) return false;
  }
  return true;
}

std::vector<Mesh> meshes() {
  Mesh far = moved(torus(24, 12, 0.3f), 5, 1000);
  Mesh lonely = icosphere(2);
  lonely.add_triangle({9, 0, 0}, {9, 0.1f, 0}, {9, 0, 0.1f});
  return {bumpy_sphere(3), torus(40, 20, 0.25f), cube(2), far, lonely, octahedron()};
}

}  // namespace

TEST_CASE("a close box holds every vertex with its margin and lies in the box of the bounds") {
  Random random(91);
  for (const Builder builder : {Builder::binned_sah, Builder::spatial_splits, Builder::lbvh}) {
    for (const Mesh& mesh : meshes()) {
      const Block block = build_mesh(mesh, geometry_flag::opaque, {build_flag::none, builder});
      for (int i = 0; i < 60; ++i) {
        Matrix m;
        random_matrix(random, m);
        Box outer = world_box(m, bounds_of(block));
        for (int levels = 0; levels < 6; ++levels) {
          const Box box = close_world_box(m, block.data(), levels);
          REQUIRE(lies_within(box, outer));
          for (const Point& vertex : mesh.vertices) REQUIRE(holds(box, m, vertex));
          outer = box;
        }
      }
    }
  }
}

TEST_CASE("boxes hold objects that are too small for doubles to tell from where they are") {
  Random random(93);
  const Mesh mesh = moved(bumpy_sphere(2), 0x1p-57f, 0);
  const Block block = build_mesh(mesh);
  for (int i = 0; i < 100; ++i) {
    Matrix m;
    random_matrix(random, m);
    for (auto& row : m) row[3] = random.chance(2) ? 1.0f : -2.0f;
    for (const int levels : {0, 3}) {
      const Box box = close_world_box(m, block.data(), levels);
      for (const Point& vertex : mesh.vertices) REQUIRE(holds(box, m, vertex));
    }
  }
}

TEST_CASE("a turned ball's box is hardly larger than the ball") {
  const Block ball = build_mesh(icosphere(4));
  const float c = 0.70710678f;
  const Matrix turned{{c, 0, -c, 5}, {0, 1, 0, 6}, {c, 0, c, 7}};
  const double loose = world_box(turned, bounds_of(ball)).half_area();
  double before = loose;
  for (int levels = 2; levels < 4; ++levels) {  // the first eight children have the corners of the bounds
    const double area = close_world_box(turned, ball.data(), levels).half_area();
    CHECK(area < before);
    before = area;
  }
  CHECK(loose > 1.6 * 12);  // a cube's half area around the ball is 12
  CHECK(before < 1.15 * 12);
}

TEST_CASE("what looks along the axes has the box of its bounds, as have structures without nodes and lazy ones") {
  const Matrix straight{{0, -4, 0, 8}, {0.5f, 0, 0, -3}, {0, 0, 16, 32}},
      turned{{1, 2, 0, 0}, {-2, 1, 0, 0}, {0, 1, 1, 0}};
  const Block ball = build_mesh(icosphere(3));
  CHECK(same(close_world_box(straight, ball.data(), 3), world_box(straight, bounds_of(ball))));
  CHECK(!same(close_world_box(turned, ball.data(), 3), world_box(turned, bounds_of(ball))));
  Mesh one;
  one.add_triangle({0, 0, 0}, {1, 2, 3}, {3, -1, 1});
  const Block blocks[]{build_mesh(one), build_mesh(Mesh{}),
                       build_mesh(icosphere(4), geometry_flag::opaque, build_flag::lazy)};
  REQUIRE(is_lazy(blocks[2].header()));
  for (const Block& block : blocks) {
    CHECK(same(close_world_box(turned, block.data(), 3), world_box(turned, bounds_of(block))));
  }
}

TEST_CASE("procedural boxes are held, corners and all") {
  Random random(92);
  std::vector<std::array<Point, 2>> boxes;
  while (boxes.size() < 300) {
    const auto any = [&] { return random.uniform(-5, 5); };
    const Point low{any(), any(), any()};
    if (low[0] * low[0] + low[1] * low[1] + low[2] * low[2] < 25)
      boxes.push_back({low, {low[0] + 0.2f, low[1] + 0.1f, low[2] + 0.3f}});
  }
  AabbGeometry geometry;
  geometry.boxes = reinterpret_cast<const std::byte*>(boxes.data());
  geometry.box_count = boxes.size();
  const Block block = build_geometries(std::vector{geometry});
  for (int i = 0; i < 100; ++i) {
    Matrix m;
    random_matrix(random, m);
    const Box box = close_world_box(m, block.data(), 3);
    for (const auto& of : boxes) {
      for (int corner = 0; corner < 8; ++corner)
        REQUIRE(holds(box, m, {of[corner & 1][0], of[corner >> 1 & 1][1], of[corner >> 2][2]}));
    }
  }
}

TEST_CASE("how closely boxes fit follows from the build flags") {
  const Block ball = build_mesh(icosphere(4));
  const float c = 0.70710678f;
  const InstanceDesc desc = instance_of(ball, {c, 0, -c, 5, 0, 1, 0, 6, c, 0, c, 7});
  const auto area = [&](uint32_t flags) { return bounds_of(build_instances({desc}, flags)).half_area(); };
  CHECK(area(build_flag::prefer_fast_build) == world_box(desc.transform, bounds_of(ball)).half_area());
  CHECK(area(build_flag::none) < area(build_flag::prefer_fast_build));
  CHECK(area(build_flag::prefer_fast_trace) < area(build_flag::none));
}
