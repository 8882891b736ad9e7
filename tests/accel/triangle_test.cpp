#include "rational_oracle.h"
#include "triangle_cases.h"

#include <rayloom/accel/triangle.h>

#include <catch2/catch.hpp>
#include <cstdio>

namespace rayloom::accel {
namespace {

using test::Case;
using test::Family;
using test::Random;

constexpr float unbounded[2][3] = {{-1, -1, -1}, {1, 1, 1}};  // boxes play no part in these tests

PreparedRay prepare(const Ray& ray) { return prepare_ray(ray, unbounded[0], unbounded[1]); }

std::optional<TriangleHit> intersect(const Case& c) {
  return intersect_triangle(prepare(c.ray), c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data());
}

/// The oracle's answer limited to the ray's interval as triangle.h defines it.
bool oracle_hits(const Ray& ray, const std::optional<test::RationalHit>& exact) {
  if (!exact || test::is_nearest(std::numeric_limits<float>::infinity(), exact->t)) return false;
  if (exact->t <= mpq_class(ray.t_min)) return false;
  // t > t_min still rounds down to t_min when nearer to it than to its successor.
  return !test::is_nearest(ray.t_min, exact->t);
}

void check_equal(const TriangleHit& hit, const test::RationalHit& exact) {
  CHECK(test::is_nearest(hit.t, exact.t));
  CHECK(test::is_nearest(hit.u, exact.u));
  CHECK(test::is_nearest(hit.v, exact.v));
  CHECK(hit.front == exact.front);
  CHECK(hit.u >= 0);
  CHECK(hit.v >= 0);
  CHECK(hit.u + hit.v <= 1);
}

Case with_negated_direction(Case c) {
  for (float& value : c.ray.direction) value = -value;
  return c;
}

TEST_CASE("hits equal the exact rational definition, correctly rounded", "[oracle]") {
  for (const Family family : test::all_families) {
    Random random(1000 + static_cast<uint64_t>(family));
    int hits = 0;
    constexpr int count = 6000;
    for (int i = 0; i < count; ++i) {
      const Case c = test::random_case(random, family);
      const auto hit = intersect(c);
      const auto exact = test::rational_hit(c.ray, c.triangle);
      INFO("family " << test::family_name(family) << ", case " << i);
      REQUIRE(hit.has_value() == oracle_hits(c.ray, exact));
      if (!hit) continue;
      ++hits;
      check_equal(*hit, *exact);
    }
    std::printf("%-15s %5d of %d hit\n", test::family_name(family).data(), hits, count);
    if (family != Family::repeated) CHECK(hits > 20);
  }
}

TEST_CASE("degenerate triangles are never hit", "[unit]") {
  Random random(7);
  for (int i = 0; i < 20000; ++i) {
    Case c = test::random_case(random, i % 2 ? Family::repeated : Family::vertex);
    c.triangle[random.below(3)] = c.triangle[1];
    c.triangle[2] = c.triangle[0];
    REQUIRE_FALSE(intersect(c));
    REQUIRE_FALSE(intersect(with_negated_direction(c)));
  }
}

TEST_CASE("an edge-on triangle is never hit", "[unit]") {
  const Case c{{{0.25f, 0.25f, 2}, 0, {0, 0, -1}, 10}, {{{0.25f, 0, 0}, {0.25f, 1, 0}, {0.25f, 1, 1}}}};
  CHECK_FALSE(intersect(c));
}

TEST_CASE("scaling the direction by a power of two scales t and changes no other bit", "[unit]") {
  Random random(11);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Case c = test::unit_case(random, i % 2 ? Family::edge : Family::inside);
    if (!test::usable(c)) continue;
    const auto hit = intersect(c);
    const int shift = static_cast<int>(random.below(81)) - 40;
    Case scaled = c;
    for (float& value : scaled.ray.direction) value = std::ldexp(value, shift);
    const auto scaled_hit = intersect(scaled);
    REQUIRE(hit.has_value() == scaled_hit.has_value());
    if (!hit) continue;
    ++hits;
    REQUIRE(scaled_hit->t == std::ldexp(hit->t, -shift));
    REQUIRE(scaled_hit->u == hit->u);
    REQUIRE(scaled_hit->v == hit->v);
    REQUIRE(scaled_hit->front == hit->front);
  }
  CHECK(hits > 4000);
}

TEST_CASE("front faces are those whose normal points against the ray", "[unit]") {
  const Case c{{{0.25f, 0.25f, 1}, 0, {0, 0, -1}, 10}, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
  REQUIRE(intersect(c));
  CHECK(intersect(c)->hit_kind() == hit_kind_triangle_front_face);
  Case turned = c;
  std::swap(turned.triangle[1], turned.triangle[2]);
  REQUIRE(intersect(turned));
  CHECK(intersect(turned)->hit_kind() == hit_kind_triangle_back_face);
  CHECK(intersect(turned)->u == intersect(c)->v);
}

TEST_CASE("the interval is open below and closed above, on the rounded t", "[unit]") {
  Case c{{{0.25f, 0.25f, 3}, 0, {0, 0, -1}, 10}, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
  const auto hit_in = [&](float t_min, float t_far) {
    c.ray.t_min = t_min;
    return intersect_triangle(prepare(c.ray), c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data(), t_far)
        .has_value();
  };
  CHECK(hit_in(0, 3));
  CHECK_FALSE(hit_in(0, std::nextafter(3.0f, 0.0f)));
  CHECK_FALSE(hit_in(3, 4));
  CHECK(hit_in(std::nextafter(3.0f, 0.0f), 4));
}

TEST_CASE("a vertex that is not finite makes a triangle unhittable", "[unit]") {
  Random random(13);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity()};
  for (int i = 0; i < 3000; ++i) {
    Case c = test::unit_case(random, Family::inside);
    for (uint32_t n = 1 + random.below(9); n > 0; --n)
      c.triangle[random.below(3)][random.below(3)] = bad[random.below(3)];
    REQUIRE_FALSE(intersect(c));
    const PreparedRay ray = prepare(c.ray);
    REQUIRE_FALSE(finish_triangle(ray, c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data()));
  }
}

TEST_CASE("deciding by the rounded edge functions alone would fail the oracle", "[oracle]") {
  // The mutation these tests must be able to catch: no error bound, no tie rule.
  const auto naive = [](const Case& c) {
    const PreparedRay ray = prepare(c.ray);
    const auto [kx, ky, kz] = ray.axis;
    float x[3], y[3];
    for (int i = 0; i < 3; ++i) {
      const float z = c.triangle[i][kz] - c.ray.origin[kz];
      x[i] = std::fma(-ray.shear[0], z, c.triangle[i][kx] - c.ray.origin[kx]);
      y[i] = std::fma(-ray.shear[1], z, c.triangle[i][ky] - c.ray.origin[ky]);
    }
    float e[3];
    for (int i = 0; i < 3; ++i) e[i] = std::fma(x[i], y[(i + 1) % 3], -(y[i] * x[(i + 1) % 3]));
    return (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
  };
  for (const Family family : {Family::edge, Family::vertex, Family::grid}) {
    Random random(17);
    int wrong = 0;
    for (int i = 0; i < 2000; ++i) {
      const Case c = test::unit_case(random, family);
      if (test::usable(c)) wrong += naive(c) != test::rational_hit(c.ray, c.triangle).has_value();
    }
    std::printf("naive decision wrong for %d of 2000 %s rays\n", wrong, test::family_name(family).data());
    CHECK(wrong > 50);
  }
}

}  // namespace
}  // namespace rayloom::accel
