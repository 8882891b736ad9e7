#include "lane_cases.h"
#include "rational_oracle.h"
#include "triangle_cases.h"

#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/simd/lanes_scalar.h>
#include <rayloom/accel/triangle.h>

#include <catch2/catch.hpp>
#include <cstdio>

namespace rayloom::accel {
namespace {

using test::Case;
using test::Family;
using test::Point;
using test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

struct Box {
  Point low, high;

  void include(const Point& p) {
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  }
};

Box box_of(const test::Triangle& triangle) {
  Box box{triangle[0], triangle[0]};
  for (const Point& vertex : triangle) box.include(vertex);
  return box;
}

PreparedRay prepare(const Ray& ray, const Box& root, float pad_scale = 1) {
  return prepare_ray(ray, root.low.data(), root.high.data(), pad_scale);
}

Node8 node_of(const Box& box) {
  Node8 node{};
  for (int k = 0; k < 3; ++k) node.bounds[k][0][0] = box.low[k], node.bounds[k][1][0] = box.high[k];
  return node;
}

/// Whether the box test lets a hit at t through.
bool enters(const PreparedRay& ray, const Box& box, float t) {
  const Node8 node = node_of(box);
  return (scalar::test_node(scalar::BoxLanes(ray), node, ray.near_limit(ray.t_min), ray.far_limit(t)).mask & 1) != 0;
}

/// The same ray with its box pads taken away.
PreparedRay without_pad(PreparedRay ray) {
  for (int k = 0; k < 3; ++k) ray.near_offset[k] = ray.far_offset[k] = -ray.origin[k] * ray.reciprocal[k];
  return ray;
}

TEST_CASE("rays with values no rule gives a meaning to are invalid", "[unit]") {
  const Box root{{-1, -1, -1}, {1, 1, 1}};
  const Ray good{{0, 0, 0}, 0, {0, 0, 1}, infinity};
  CHECK(prepare(good, root).valid);
  const auto changed = [&](auto change) {
    Ray ray = good;
    change(ray);
    return prepare(ray, root).valid;
  };
  for (const float bad : {nan, infinity, -infinity}) {
    for (int k = 0; k < 3; ++k) {
      CHECK_FALSE(changed([&](Ray& ray) { ray.origin[k] = bad; }));
      CHECK_FALSE(changed([&](Ray& ray) { ray.direction[k] = bad; }));
    }
  }
  CHECK_FALSE(changed([](Ray& ray) { ray.direction[2] = -0.0f; }));
  CHECK_FALSE(changed([](Ray& ray) { ray.t_min = nan; }));
  CHECK_FALSE(changed([](Ray& ray) { ray.t_max = nan; }));
  CHECK_FALSE(changed([](Ray& ray) { ray.t_min = -0x1p-149f; }));
  CHECK_FALSE(changed([](Ray& ray) { ray.t_min = 2, ray.t_max = 1; }));
  CHECK(changed([](Ray& ray) { ray.t_min = ray.t_max = 1; }));
  CHECK(changed([](Ray& ray) { ray.t_min = infinity; }));
  CHECK(changed([](Ray& ray) { ray.direction[2] = 0x1p-149f; }));
}

TEST_CASE("the dominant axis is the largest component, the lowest of equals", "[unit]") {
  const Box root{{-1, -1, -1}, {1, 1, 1}};
  const auto axis = [&](float x, float y, float z) { return prepare({{0, 0, 0}, 0, {x, y, z}, 1}, root).axis[2]; };
  CHECK(axis(1, 1, 1) == 0);
  CHECK(axis(1, -2, 2) == 1);
  CHECK(axis(0, 1, -3) == 2);
  CHECK(axis(-1, 1, 0) == 0);
}

TEST_CASE("limits convert to box space outward", "[oracle]") {
  Random random(31);
  for (int i = 0; i < 20000; ++i) {
    const uint32_t style = random.below(4);
    Box root{};
    for (int k = 0; k < 3; ++k) {
      const float a = test::any_coordinate(random, style), b = test::any_coordinate(random, style);
      root.low[k] = std::min(a, b), root.high[k] = std::max(a, b);
    }
    const PreparedRay ray = prepare(test::any_ray(random, style), root);
    if (!ray.valid) continue;
    const float t = std::fabs(random.any_finite());
    const mpq_class exact = mpq_class(t) * mpq_class(ray.box_scale);
    REQUIRE(mpq_class(ray.near_limit(t)) <= exact);
    const float far = ray.far_limit(t);
    REQUIRE((std::isinf(far) || mpq_class(far) >= exact));
  }
}

TEST_CASE("no box around an exact hit is missed at that hit's t", "[oracle]") {
  for (const Family family : test::all_families) {
    Random random(100 + static_cast<uint64_t>(family));
    int hits = 0, lost_without_pad = 0;
    for (int i = 0; i < 60000; ++i) {
      const Case c = test::random_case(random, family);
      Box root = box_of(c.triangle);
      if (random.chance(2)) root.include(test::lerp(c.triangle[0], {0, 0, 0}, 2));
      if (!std::isfinite(root.low[0] + root.low[1] + root.low[2] + root.high[0] + root.high[1] + root.high[2]))
        continue;
      const PreparedRay ray = prepare(c.ray, root);
      const auto hit = intersect_triangle(ray, c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data());
      if (!hit) continue;
      ++hits;
      INFO(test::family_name(family) << " case " << i);
      REQUIRE(enters(ray, box_of(c.triangle), hit->t));
      REQUIRE(enters(ray, root, hit->t));
      lost_without_pad += !enters(without_pad(ray), box_of(c.triangle), hit->t);
    }
    std::printf("%-15s %6d hits, %5d lost without a pad\n", test::family_name(family).data(), hits, lost_without_pad);
    CHECK(hits > 200);
    if (family == Family::vertex) CHECK(lost_without_pad > 0);  // the pad is needed
  }
}

/// Exact entry and exit of a box, nullopt if the line misses it.
struct Slab {
  mpq_class entry, exit;
};

std::optional<Slab> exact_slab(const Ray& ray, const Box& box) {
  Slab slab{-mpq_class(0x1p500), mpq_class(0x1p500)};
  for (int k = 0; k < 3; ++k) {
    const mpq_class origin = ray.origin[k], low = box.low[k], high = box.high[k], direction = ray.direction[k];
    if (sgn(direction) == 0) {
      if (origin < low || origin > high) return std::nullopt;
      continue;
    }
    const mpq_class a = (low - origin) / direction, b = (high - origin) / direction;
    slab.entry = std::max(slab.entry, std::min(a, b));
    slab.exit = std::min(slab.exit, std::max(a, b));
  }
  if (slab.entry > slab.exit) return std::nullopt;
  return slab;
}

/// The float nearest to a positive rational.
float nearest(const mpq_class& value) {
  float guess = static_cast<float>(value.get_d());
  if (std::isinf(guess)) return guess;
  for (const float candidate : {guess, std::nextafter(guess, 0.0f), std::nextafter(guess, infinity)}) {
    if (test::is_nearest(candidate, value)) return candidate;
  }
  FAIL("no nearest float");
  return nan;
}

TEST_CASE("no point of a box inside the interval is missed, and few boxes beside the ray are entered", "[oracle]") {
  Random random(41);
  int through = 0, beside = 0, entered_beside = 0;
  for (int i = 0; i < 60000; ++i) {
    const uint32_t style = random.below(4);
    Box box{};
    for (int k = 0; k < 3; ++k) {
      const float a = test::any_coordinate(random, style);
      const float b = random.chance(6) ? a : test::any_coordinate(random, style);
      box.low[k] = std::min(a, b), box.high[k] = std::max(a, b);
    }
    Ray given = test::any_ray(random, style);
    given.t_min = 0, given.t_max = infinity;
    if (random.chance(4)) given.origin[random.below(3)] = box.low[0];
    const PreparedRay ray = prepare(given, box);
    if (!ray.valid) continue;
    const auto slab = exact_slab(given, box);
    if (!slab || slab->exit <= 0) {
      // Sizes within one scene only: the pad is relative to the farthest plane.
      if (style == 0) ++beside, entered_beside += enters(ray, box, infinity);
      continue;
    }
    for (mpq_class t : {slab->entry, slab->exit, mpq_class((slab->entry + slab->exit) / 2)}) {
      if (t <= 0) continue;
      const float rounded = nearest(t);
      if (rounded == 0 || std::isinf(rounded)) continue;
      ++through;
      INFO("style " << style << " case " << i);
      REQUIRE(enters(ray, box, rounded));
    }
  }
  std::printf("%d points in boxes, %d boxes beside the ray, %d of them entered\n", through, beside, entered_beside);
  CHECK(through > 8000);
  CHECK(beside > 10000);
  CHECK(entered_beside * 100 < beside);
}

using Matrix = std::array<std::array<double, 3>, 3>;

double norm(const Matrix& m) {
  double largest = 0;
  for (const auto& row : m) largest = std::max(largest, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
  return largest;
}

double cofactor(const Matrix& m, int row, int column) {
  const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
  return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
}

Matrix inverse_of(const Matrix& m) {
  const double determinant = m[0][0] * cofactor(m, 0, 0) + m[0][1] * cofactor(m, 0, 1) + m[0][2] * cofactor(m, 0, 2);
  Matrix out{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i][j] = cofactor(m, j, i) / determinant;
  }
  return out;
}

double residual(const Matrix& m, const Matrix& w) {
  Matrix product{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) product[i][j] = m[i][0] * w[0][j] + m[i][1] * w[1][j] + m[i][2] * w[2][j] - (i == j);
  }
  return norm(product);
}

/// The smallest world box a builder may give an instance of one triangle: its exact image widened as prepare_ray()
/// asks.
Box world_box(const Matrix& m, const Point& translation, const test::Triangle& triangle) {
  double extent = 0;
  for (const Point& vertex : triangle) {
    for (const float value : vertex) extent = std::max(extent, std::fabs(double{value}));
  }
  const double pad = 0x1p-22 * norm(m) * extent * (1 + 0x1p-40);
  Box out{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Point& vertex : triangle) {
    for (int k = 0; k < 3; ++k) {
      mpq_class image = translation[k];
      for (int j = 0; j < 3; ++j) image += mpq_class(m[k][j]) * mpq_class(vertex[j]);
      const auto low = static_cast<float>(mpq_class(image - pad).get_d());
      const auto high = static_cast<float>(mpq_class(image + pad).get_d());
      out.low[k] = std::min(out.low[k], std::nextafter(low, -infinity));
      out.high[k] = std::max(out.high[k], std::nextafter(high, infinity));
    }
  }
  return out;
}

Ray object_ray(const Ray& world, const Matrix& w, const Point& translation) {
  Ray out = world;
  for (int i = 0; i < 3; ++i) {
    double origin = 0, direction = 0;
    for (int j = 0; j < 3; ++j) {
      origin += w[i][j] * (double{world.origin[j]} - double{translation[j]});
      direction += w[i][j] * double{world.direction[j]};
    }
    out.origin[i] = static_cast<float>(origin);
    out.direction[i] = static_cast<float>(direction);
  }
  return out;
}

TEST_CASE("a top-level ray enters the box of every instance its object-space copy hits", "[oracle]") {
  Random random(51);
  int hits = 0, lost_unscaled = 0;
  for (int i = 0; i < 60000; ++i) {
    Matrix m;
    for (auto& row : m) {
      for (double& value : row) value = random.uniform(-1, 1);
    }
    if (random.chance(2)) {  // nearly flat: a large condition number
      for (int j = 0; j < 3; ++j) m[2][j] = static_cast<float>(m[0][j] + random.scaled(-20, -2));
    }
    const Matrix w = inverse_of(m);
    const double kappa = norm(m) * norm(w) + 0x1p24 * residual(m, w);
    if (!(kappa < 0x1p30)) continue;
    const float reach = random.chance(2) ? 1.0f : 1000.0f;
    const Point translation = test::random_point(random, reach);
    test::Triangle triangle = test::shape(random, random.chance(2) ? Family::needle : Family::inside);
    const float size = std::ldexp(1.0f, -static_cast<int>(random.below(12)));
    for (Point& vertex : triangle) {
      for (float& value : vertex) value *= size;
    }
    const Point target = test::target_of(random, triangle, Family::vertex);
    Point world_target;
    for (int k = 0; k < 3; ++k) {
      world_target[k] =
          static_cast<float>(m[k][0] * target[0] + m[k][1] * target[1] + m[k][2] * target[2] + translation[k]);
    }
    const Ray world = test::ray_towards(test::random_point(random, reach * 3), world_target);
    const Ray local = object_ray(world, w, translation);
    const Box object = box_of(triangle);
    const auto hit =
        intersect_triangle(prepare(local, object), triangle[0].data(), triangle[1].data(), triangle[2].data());
    if (!hit) continue;
    ++hits;
    const Box box = world_box(m, translation, triangle);
    REQUIRE(enters(prepare(world, box, static_cast<float>(1 + kappa * 1.0001)), box, hit->t));
    lost_unscaled += !enters(prepare(world, box), box, hit->t);
  }
  std::printf("%d instance hits, %d lost without pad_scale\n", hits, lost_unscaled);
  CHECK(hits > 5000);
  CHECK(lost_unscaled > 0);  // pad_scale is needed
}

}  // namespace
}  // namespace rayloom::accel
