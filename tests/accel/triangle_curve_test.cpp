#include <rayloom/accel/triangle_curve.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <limits>

#include "meshes.h"
#include "random.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

Mesh scattered(size_t count, float spread, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const auto any = [&] { return spread * random.uniform(-1, 1); };
    const Point a{any(), any(), any()};
    mesh.add_triangle(a, {a[0] + 0.01f, a[1], a[2]}, {a[0], a[1] + 0.01f, a[2] - 0.01f});
  }
  return mesh;
}

bool same(const PrimitiveRef& a, const PrimitiveRef& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

/// Every active triangle once, in the order of codes, with the box that triangle_refs gives it.
void check_curve(const std::vector<TriangleGeometry>& geometries, bool keep_degenerate) {
  const TriangleCurve order(geometries, keep_degenerate);
  PrimitiveRefs refs(order.keys().size());
  order.gather(order.keys(), refs.data());
  size_t descents = 0;
  for (size_t i = 0; i < refs.size(); ++i) {
    REQUIRE(order.keys()[i].code == order.curve().code(refs[i]) >> 31);
    REQUIRE(order.code(order.keys()[i].index) == order.curve().code(refs[i]));
    if (i > 0) descents += order.keys()[i - 1].code > order.keys()[i].code;
  }
  CHECK(descents == 0);
  std::sort(refs.begin(), refs.end(), name_less);
  const PrimitiveRefs expected = triangle_refs(geometries, keep_degenerate);
  REQUIRE(refs.size() == expected.size());
  CHECK(std::equal(refs.begin(), refs.end(), expected.begin(), same));
}

}  // namespace

TEST_CASE("the curve holds every active triangle of all geometries once") {
  Mesh first = scattered(30000, 1, 121), second = bumpy_sphere(3);
  first.vertices[300][1] = std::numeric_limits<float>::quiet_NaN();
  first.vertices[600][2] = -std::numeric_limits<float>::infinity();
  first.vertices[900] = first.vertices[901];
  first.vertices[1200][0] = -0.0f;
  const Transform3x4 transform{2, 0, 0, 1, 0, 0, 3, 0, 0, 1, 0, -2};
  TriangleGeometry moved = second.geometry(), list = first.geometry();
  moved.transform = transform.data();
  list.index_format = IndexFormat::none;
  list.indices = nullptr;
  for (const bool keep_degenerate : {false, true})
    check_curve({first.geometry(), moved, list, second.geometry()}, keep_degenerate);
  const std::vector alone{first.geometry()};
  CHECK(TriangleCurve(alone, false).keys().size() == 30000 - 3);
}

TEST_CASE("vertices that no triangle uses do not spoil the curve") {
  Mesh mesh = scattered(5000, 1, 122);
  mesh.add({1e30f, 0, 0});
  mesh.add({0, std::numeric_limits<float>::quiet_NaN(), 0});
  const std::vector geometries{mesh.geometry()};
  CHECK(TriangleCurve(geometries, false).curve().extent() < 2.1);
  check_curve(geometries, false);
  for (int i = 0; i < 20000; ++i) mesh.add({-500, 0, 0});  // more than triangles use
  check_curve({mesh.geometry()}, false);
}

TEST_CASE("keys that agree for more than a leaf are told apart by 63 bits") {
  Mesh mesh = scattered(3000, 1e-5f, 123);
  for (Point& p : mesh.vertices)
    for (float& x : p) x *= 1e-3f;
  mesh.add_triangle({1, 1, 1}, {1, 1, 0.5f}, {1, 0.5f, 1});
  const std::vector geometries{mesh.geometry()};
  const TriangleCurve order(geometries, false);
  size_t descents = 0;
  for (size_t i = 1; i < order.keys().size(); ++i)
    descents += order.code(order.keys()[i - 1].index) > order.code(order.keys()[i].index);
  CHECK(descents == 0);
  CHECK(order.keys().front().code == order.keys()[2999].code);
}

TEST_CASE("an index out of range is named, the lowest first, for any number of threads") {
  Mesh mesh = scattered(100000, 1, 124);
  mesh.triangles[70000][1] = 400000;
  mesh.triangles[90000][1] = 500000;
  const std::vector geometries{mesh.geometry()};
  for (const unsigned threads : {1u, 3u}) {
    const ThreadLimit limit(threads);
    CHECK_THROWS_WITH(TriangleCurve(geometries, false), Catch::Contains("triangle 70000"));
  }
}
