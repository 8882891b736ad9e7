#include "rational_oracle.h"
#include "triangle_cases.h"

#include <rayloom/accel/exact_triangle.h>

#include <catch2/catch.hpp>

namespace rayloom::accel {
namespace {

using test::Case;
using test::Family;
using test::Random;

PreparedRay prepare(const Ray& ray) {
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  return prepare_ray(ray, box[0], box[1]);
}

TriangleCorners corners_of(const Case& c) {
  return {{c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data()}};
}

TriangleHit exact_hit(const PreparedRay& ray, const TriangleCorners& corners) {
  TriangleHit hit{};
  exact_quotients(ray, corners, {}, hit);
  return hit;
}

void check_edges(const Case& c) {
  const ExactEdges edges = exact_edges(prepare(c.ray), corners_of(c));
  for (int i = 0; i < 3; ++i) {
    const test::Projected a = test::project(c.ray, c.triangle[i]), b = test::project(c.ray, c.triangle[(i + 1) % 3]);
    REQUIRE(edges.sign[i] == test::shifted_sign(a, b));
    REQUIRE(edges.on_edge[i] == (sgn(test::edge_function(a, b)) == 0));
  }
}

TEST_CASE("edge signs equal the rational ones", "[oracle]") {
  for (const Family family : test::all_families) {
    Random random(81 + static_cast<uint64_t>(family));
    for (int i = 0; i < 4000; ++i) {
      INFO(test::family_name(family) << " case " << i);
      check_edges(test::random_case(random, family));
    }
  }
}

/// One of the floats whose bits lie farthest apart, or zero.
float extreme(Random& random) {
  constexpr float magnitudes[] = {0x1p-149f, 0x1.fffffep-127f, 0x1.fffffep127f, 0x1p127f, 1.0f, 0.0f};
  return magnitudes[random.below(6)] * (random.chance(2) ? -1.0f : 1.0f);
}

TEST_CASE("the integers are wide enough for any finite floats", "[oracle]") {
  Random random(91);
  for (int i = 0; i < 20000; ++i) {
    Case c{};
    for (auto& vertex : c.triangle) {
      for (float& value : vertex) value = extreme(random);
    }
    for (float& value : c.ray.origin) value = extreme(random);
    for (float& value : c.ray.direction) value = extreme(random);
    c.ray.t_max = 1;
    if (test::usable(c)) check_edges(c);
  }
}

TEST_CASE("quotients of extreme triangles are rounded to nearest", "[oracle]") {
  Random random(93);
  int hits = 0;
  for (int i = 0; i < 60000; ++i) {
    Case c = test::any_bits_case(random);
    if (random.chance(2)) {
      for (auto& vertex : c.triangle) {
        for (float& value : vertex) value = extreme(random);
      }
    }
    if (!test::usable(c)) continue;
    const auto exact = test::rational_hit(c.ray, c.triangle);
    if (!exact) continue;
    ++hits;
    const TriangleHit hit = exact_hit(prepare(c.ray), corners_of(c));
    REQUIRE(test::is_nearest(hit.t, exact->t));
    REQUIRE(test::is_nearest(hit.u, exact->u));
    REQUIRE(test::is_nearest(hit.v, exact->v));
    REQUIRE(hit.front == exact->front);
  }
  CHECK(hits > 1000);
}

TEST_CASE("a quotient halfway between two floats goes to the even one", "[unit]") {
  // t = 1 + 2^-24 and 1 + 3 * 2^-24, both from exact heights above the plane z = 0.
  const auto t_of = [](float origin_z, float low) {
    Case c{{{0.25f, 0.25f, origin_z}, 0, {0, 0, -1}, 10}, {{{0, 0, low}, {1, 0, low}, {0, 1, low}}}};
    return exact_hit(prepare(c.ray), corners_of(c)).t;
  };
  CHECK(t_of(1, -0x1p-24f) == 1.0f);
  CHECK(t_of(1, -0x1.8p-23f) == 1.0f + 0x1p-22f);
  CHECK(t_of(1, -0x1.000002p-24f) == 1.0f + 0x1p-23f);
}

TEST_CASE("an edge-on triangle has no quotients", "[unit]") {
  const Case c{{{0.25f, 0.25f, 2}, 0, {0, 0, -1}, 10}, {{{0.25f, 0, 0}, {0.25f, 1, 0}, {0.25f, 1, 1}}}};
  CHECK(std::isnan(exact_hit(prepare(c.ray), corners_of(c)).t));
}

}  // namespace
}  // namespace rayloom::accel
