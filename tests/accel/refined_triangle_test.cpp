// Hits that doubles cannot round: which arithmetic decides them, and that the answer is the exact one.

#include "rational_oracle.h"
#include "triangle_cases.h"

#include <rayloom/accel/refined_triangle.h>

#include <catch2/catch.hpp>
#include <cstdio>

namespace rayloom::accel {
namespace {

using test::Case;
using test::Family;
using test::Point;
using test::Random;

struct Observed {
  std::optional<TriangleHit> hit;
  TriangleEffort effort;
};

Observed observe(const Case& c, bool certain = false) {
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  Observed out;
  out.hit = observed_hit(prepare_ray(c.ray, box[0], box[1]),
                         {{c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data()}},
                         std::numeric_limits<float>::infinity(), certain, out.effort);
  return out;
}

void check_equal(const TriangleHit& hit, const test::RationalHit& exact) {
  REQUIRE(test::is_nearest(hit.t, exact.t));
  REQUIRE(test::is_nearest(hit.u, exact.u));
  REQUIRE(test::is_nearest(hit.v, exact.v));
  REQUIRE(hit.front == exact.front);
}

/// How many of some cases went how far.
struct Levels {
  int cases = 0, hits = 0, refined = 0, integer_signs = 0, integer_quotients = 0;

  void add(const Observed& observed) {
    ++cases;
    hits += observed.hit.has_value();
    refined += observed.effort.refined;
    integer_signs += observed.effort.integer_signs;
    integer_quotients += observed.effort.integer_quotients > 0;
  }
  void print(const char* name) const {
    std::printf("%-15s %6d cases, %6d hit: double-double %5d, integers for signs %5d, for quotients %5d\n", name, cases,
                hits, refined, integer_signs, integer_quotients);
  }
};

/// A small triangle near zero seen from afar, where edge functions cancel: the distance is 2^10 to 2^20 times its size.
Case far_case(Random& random, Family family) {
  Case out{{}, test::shape(random, family)};
  const float size = std::ldexp(1.0f, -static_cast<int>(random.below(12)));
  for (Point& vertex : out.triangle)
    for (float& value : vertex) value *= size;
  const float distance = std::ldexp(size, 10 + static_cast<int>(random.below(11)));
  out.ray = test::ray_towards(test::random_point(random, distance), test::target_of(random, out.triangle, family));
  return out;
}

TEST_CASE("far and thin triangles need double-double, not integers", "[oracle]") {
  for (const Family family : {Family::inside, Family::edge, Family::needle}) {
    Random random(211 + static_cast<uint64_t>(family));
    Levels levels;
    for (int i = 0; i < 10000; ++i) {
      const Case c = far_case(random, family);
      if (!test::usable(c)) continue;
      const Observed observed = observe(c);
      levels.add(observed);
      const auto exact = test::rational_hit(c.ray, c.triangle);
      INFO(test::family_name(family) << " case " << i);
      REQUIRE(observed.hit.has_value() == (exact && exact->t > 0));
      if (observed.hit) check_equal(*observed.hit, *exact);
    }
    levels.print(test::family_name(family).data());
    CHECK(levels.hits > 1000);
    CHECK(levels.refined > 20);
    CHECK(levels.integer_signs == 0);
    CHECK(levels.integer_quotients == 0);
  }
}

TEST_CASE("every family keeps its answers where double-double decides", "[oracle]") {
  for (const Family family : test::all_families) {
    Random random(223 + static_cast<uint64_t>(family));
    Levels levels;
    for (int i = 0; i < 30000; ++i) {
      const Case c = test::random_case(random, family);
      const Observed observed = observe(c);
      levels.add(observed);
      if (!observed.effort.refined || !observed.hit) continue;
      const auto exact = test::rational_hit(c.ray, c.triangle);
      INFO(test::family_name(family) << " case " << i);
      REQUIRE(exact);
      check_equal(*observed.hit, *exact);
      // No weight vanished, so the decision may be skipped.
      if (sgn(exact->u) > 0 && sgn(exact->v) > 0 && exact->u + exact->v < 1) {
        const auto finished = observe(c, true).hit;
        REQUIRE(finished);
        check_equal(*finished, *exact);
      }
    }
    levels.print(test::family_name(family).data());
    CHECK(levels.integer_signs <= levels.refined);
  }
}

Case facing_down(const Point& v0, const Point& v1, const Point& v2, float x, float y) {
  return {{{x, y, 1}, 0, {0, 0, -1}, 10}, {v0, v1, v2}};
}

TEST_CASE("a depth halfway between two floats takes one integer quotient", "[unit]") {
  const float low = -0x1p-24f;
  const Observed tie = observe(facing_down({0, 0, low}, {1, 0, low}, {0, 1, low}, 0.25f, 0.25f));
  CHECK(tie.hit.value().t == 1);
  CHECK(tie.effort.integer_quotients == 1);
  CHECK_FALSE(tie.effort.integer_signs);
}

TEST_CASE("a weight halfway between two floats takes one integer quotient", "[unit]") {
  // u = x - 2^-13 y = 0.75 - 2^-25
  const Observed tie = observe(facing_down({0, 0, 0}, {1, 0, 0}, {0x1p-13f, 1, 0}, 0.75f, 0x1p-12f));
  CHECK(tie.hit.value().u == 0.75f);
  CHECK(tie.hit.value().v == 0x1p-12f);
  CHECK(tie.effort.integer_quotients == 1);
}

TEST_CASE("a depth 2^-67 off halfway takes double-double only", "[unit]") {
  // Weight 2^-20 of a vertex that lies 2^-47 off the others' plane.
  const float low = -0x1p-24f, lower = -0x1.000002p-24f, higher = -0x1.fffffep-25f;
  const Observed above = observe(facing_down({0, 0, low}, {1, 0, lower}, {0, 1, low}, 0x1p-20f, 0.25f));
  CHECK(above.hit.value().t == 1 + 0x1p-23f);
  const Observed below = observe(facing_down({0, 0, low}, {1, 0, higher}, {0, 1, low}, 0x1p-20f, 0.25f));
  CHECK(below.hit.value().t == 1);
  for (const Observed& observed : {above, below}) {
    CHECK(observed.effort.refined);
    CHECK(observed.effort.integer_quotients == 0);
  }
}

TEST_CASE("a ray through a vertex takes integers for the signs and for no weight", "[unit]") {
  const Observed vertex = observe(facing_down({0.1f, 0.2f, 0}, {1, 0, 0.5f}, {0, 1, 0.25f}, 0.1f, 0.2f));
  if (vertex.hit) {
    CHECK(vertex.hit->u == 0);
    CHECK(vertex.hit->v == 0);
  }
  CHECK(vertex.effort.integer_signs);
  CHECK(vertex.effort.integer_quotients == 0);
}

}  // namespace
}  // namespace rayloom::accel
