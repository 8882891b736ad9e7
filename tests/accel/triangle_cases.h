#pragma once

// Rays and triangles that are hard for floating point: aimed at edges and vertices, needles, degenerate, exact ties,
// and every scale and position (numerics rows K1 to K10, K15, K16).

#include "random.h"
#include "rational_oracle.h"

#include <array>
#include <string_view>

namespace rayloom::accel::test {

struct Case {
  Ray ray;
  Triangle triangle;
};

enum class Family { inside, edge, vertex, grid, needle, collinear, repeated, wild_direction, any_bits };

inline constexpr std::array<Family, 9> all_families = {Family::inside,   Family::edge,           Family::vertex,
                                                       Family::grid,     Family::needle,         Family::collinear,
                                                       Family::repeated, Family::wild_direction, Family::any_bits};

inline std::string_view family_name(Family family) {
  constexpr std::array<std::string_view, 9> names = {"inside",    "edge",     "vertex",         "grid",    "needle",
                                                     "collinear", "repeated", "wild direction", "any bits"};
  return names[static_cast<size_t>(family)];
}

inline Point random_point(Random& random, float extent) {
  return {random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-extent, extent)};
}

inline Point lerp(const Point& a, const Point& b, float s) {
  return {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])};
}

inline Ray ray_towards(const Point& origin, const Point& target) {
  Ray ray{{origin[0], origin[1], origin[2]}, 0, {}, std::numeric_limits<float>::infinity()};
  for (int k = 0; k < 3; ++k) ray.direction[k] = target[k] - origin[k];
  return ray;
}

/// A target on the triangle: an inner point, a point of an edge, or a vertex.
inline Point target_of(Random& random, const Triangle& triangle, Family family) {
  const uint32_t i = random.below(3);
  if (family == Family::vertex) return triangle[i];
  const Point on_edge = lerp(triangle[i], triangle[(i + 1) % 3], random.uniform(0, 1));
  return family == Family::edge ? on_edge : lerp(on_edge, triangle[(i + 2) % 3], random.uniform(0, 1));
}

inline Triangle shape(Random& random, Family family) {
  Triangle triangle = {random_point(random, 1), random_point(random, 1), random_point(random, 1)};
  if (family == Family::needle || family == Family::collinear) {
    triangle[2] = lerp(triangle[0], triangle[1], random.uniform(-1, 2));
  }
  if (family == Family::needle) {
    for (float& value : triangle[2]) value += random.scaled(-24, -4);
  }
  if (family == Family::repeated) triangle[random.below(3)] = triangle[random.below(3)];
  return triangle;
}

/// Integer coordinates and an axis-aligned or diagonal ray through integer or half-integer points: exact ties.
inline Case grid_case(Random& random) {
  Case out{};
  for (Point& vertex : out.triangle) {
    for (float& value : vertex) value = static_cast<float>(random.below(5)) - 2;
  }
  Point origin;
  for (float& value : origin) value = static_cast<float>(random.below(9)) / 2 - 2;
  out.ray = ray_towards(origin, origin);
  const uint32_t pattern = random.below(8);
  for (int k = 0; k < 3; ++k) out.ray.direction[k] = (pattern >> k & 1) != 0 ? (random.chance(2) ? 1.0f : -1.0f) : 0.0f;
  if (pattern == 0) out.ray.direction[random.below(3)] = -3;
  if (random.chance(4)) out.ray.direction[random.below(3)] = -0.0f;
  return out;
}

inline Case any_bits_case(Random& random) {
  Case out{};
  for (Point& vertex : out.triangle) {
    for (float& value : vertex) value = random.any_finite();
  }
  for (float& value : out.ray.origin) value = random.any_finite();
  for (float& value : out.ray.direction) value = random.any_finite();
  // Nearly all such rays miss; a third aim at a corner as well as floats allow.
  if (random.chance(3)) {
    for (int k = 0; k < 3; ++k) {
      const float towards = out.triangle[0][k] / 4 - out.ray.origin[k] / 4;
      out.ray.direction[k] = towards;
    }
  }
  out.ray.t_max = std::numeric_limits<float>::infinity();
  return out;
}

inline Case unit_case(Random& random, Family family) {
  if (family == Family::grid) return grid_case(random);
  if (family == Family::any_bits) return any_bits_case(random);
  Case out{{}, shape(random, family)};
  const Point origin = random_point(random, random.chance(3) ? 1.0f : 10.0f);
  out.ray = ray_towards(origin, target_of(random, out.triangle, random.chance(2) ? Family::edge : family));
  for (float& value : out.ray.direction) {
    if (family == Family::edge || family == Family::vertex) value = random.nudged(value, 4);
    if (family == Family::wild_direction && random.chance(2))
      value = random.chance(4) ? 0.0f : random.scaled(-149, 127);
  }
  return out;
}

inline bool usable(const Case& c) {
  bool moves = false;
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(c.ray.origin[k]) || !std::isfinite(c.ray.direction[k])) return false;
    moves |= c.ray.direction[k] != 0;
    for (const Point& vertex : c.triangle) {
      if (!std::isfinite(vertex[k])) return false;
    }
  }
  return moves;
}

/// The same configuration elsewhere: coordinates times `scale` plus `offset`, rounded to float, direction times
/// direction_scale.
inline Case moved(const Case& c, float scale, float offset, float direction_scale) {
  Case out = c;
  for (Point& vertex : out.triangle) {
    for (float& value : vertex) value = value * scale + offset;
  }
  for (float& value : out.ray.origin) value = value * scale + offset;
  for (float& value : out.ray.direction) value *= direction_scale;
  return out;
}

/// A finite case with a direction, at a random scale and position.
inline Case random_case(Random& random, Family family) {
  while (true) {
    Case c = unit_case(random, family);
    if (family != Family::any_bits && random.chance(2)) {
      const float scale = random.chance(2) ? std::exp2(static_cast<float>(random.below(201)) - 100)
                                           : std::pow(10.0f, static_cast<float>(random.below(61)) - 30);
      const float offset = random.chance(2) ? std::pow(10.0f, static_cast<float>(random.below(8))) * scale : 0.0f;
      c = moved(c, scale, offset, random.chance(2) ? scale : 1.0f);
    }
    if (usable(c)) return c;
  }
}

}  // namespace rayloom::accel::test
