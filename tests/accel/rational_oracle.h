#pragma once

// The exact hit in rationals (GMP), straight from its definition in docs/numerics.md and sharing no code with accel.

#include <rayloom/accel/ray.h>

#include <gmpxx.h>

#include <array>
#include <bit>
#include <cmath>
#include <optional>

namespace rayloom::accel::test {

using Point = std::array<float, 3>;
using Triangle = std::array<Point, 3>;

struct RationalHit {
  mpq_class t, u, v;
  bool front;
};

/// The ray's view of a point: along the ray's direction onto the plane of the two other axes, and its depth.
struct Projected {
  mpq_class x, y, z;
};

inline int dominant_axis(const Ray& ray) {
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(ray.direction[k]) > std::fabs(ray.direction[axis])) axis = k;
  }
  return axis;
}

inline Projected project(const Ray& ray, const Point& vertex) {
  const int kz = dominant_axis(ray), kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const mpq_class dx = ray.direction[kx], dy = ray.direction[ky], dz = ray.direction[kz];
  const mpq_class px = mpq_class(vertex[kx]) - mpq_class(ray.origin[kx]);
  const mpq_class py = mpq_class(vertex[ky]) - mpq_class(ray.origin[ky]);
  const mpq_class pz = mpq_class(vertex[kz]) - mpq_class(ray.origin[kz]);
  return {px - dx / dz * pz, py - dy / dz * pz, pz};
}

inline mpq_class edge_function(const Projected& a, const Projected& b) { return a.x * b.y - a.y * b.x; }

/// Sign of the edge function once the ray's point is moved by (eps, eps^2), eps positive and smaller than anything.
inline int shifted_sign(const Projected& a, const Projected& b) {
  const std::array<mpq_class, 3> by_power = {edge_function(a, b), a.y - b.y, b.x - a.x};
  for (const mpq_class& coefficient : by_power) {
    if (sgn(coefficient) != 0) return sgn(coefficient);
  }
  return 0;
}

inline std::optional<RationalHit> rational_hit(const Ray& ray, const Triangle& triangle) {
  const Projected a = project(ray, triangle[0]), b = project(ray, triangle[1]), c = project(ray, triangle[2]);
  const int sign = shifted_sign(a, b);
  if (sign == 0 || shifted_sign(b, c) != sign || shifted_sign(c, a) != sign) return std::nullopt;
  const mpq_class area = edge_function(a, b) + edge_function(b, c) + edge_function(c, a);
  const mpq_class u = edge_function(c, a) / area, v = edge_function(a, b) / area;
  const mpq_class dz = ray.direction[dominant_axis(ray)];
  const mpq_class t = ((1 - u - v) * a.z + u * b.z + v * c.z) / dz;
  return RationalHit{t, u, v, sgn(area) * sgn(dz) < 0};
}

/// A float as a rational, infinity as the next value a wider exponent would have.
inline mpq_class rational_of(float value) {
  if (!std::isinf(value)) return value;
  return value > 0 ? mpq_class(0x1p128) : mpq_class(-0x1p128);
}

/// Whether `value` is the float nearest to `exact`, an even mantissa deciding between two. Overflow becomes infinite.
inline bool is_nearest(float value, const mpq_class& exact) {
  if (std::isnan(value)) return false;
  if (std::isinf(value) && abs(exact) >= mpq_class(0x1p128)) return (value > 0) == (sgn(exact) > 0);
  const bool even = (std::bit_cast<uint32_t>(value) & 1) == 0;
  const mpq_class error = abs(exact - rational_of(value));
  for (const float towards : {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()}) {
    const mpq_class other_error = abs(exact - rational_of(std::nextafter(value, towards)));
    const bool is_other = std::nextafter(value, towards) != value;
    if (is_other && (other_error < error || (other_error == error && !even))) return false;
  }
  return true;
}

}  // namespace rayloom::accel::test
