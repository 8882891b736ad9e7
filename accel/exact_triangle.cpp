#include <rayloom/accel/exact_triangle.h>

#include <boost/multiprecision/cpp_int.hpp>

#include <bit>
#include <cmath>

namespace rayloom::accel {
namespace {

// Width: a finite float is an integer multiple of 2^-149 below 2^128, hence 277 bits; a difference has 278; a
// determinant of two differences and a direction 278 + 278 + 277 + 3 = 836, and 839 the sum of three. A quotient is
// taken after shifting its numerator at most 31 bits past the denominator: 870.
namespace mp = boost::multiprecision;
using Integer = mp::number<mp::cpp_int_backend<896, 896, mp::signed_magnitude, mp::unchecked, void>, mp::et_off>;
using Vector = std::array<Integer, 3>;

/// Exponent of the lowest bit of a finite value that is set, a large number for zero.
int lowest_exponent(float value) {
  if (value == 0) return 1 << 20;
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const int field = static_cast<int>(bits >> 23 & 0xFF);
  const uint32_t mantissa = (bits & 0x7FFFFF) | (field ? 0x800000u : 0u);
  return (field ? field : 1) - 150 + std::countr_zero(mantissa);
}

int lowest_exponent(const float* values) {
  return std::min({lowest_exponent(values[0]), lowest_exponent(values[1]), lowest_exponent(values[2])});
}

/// value / 2^exponent, an integer by choice of the exponent.
Integer scaled(float value, int exponent) {
  if (value == 0) return 0;
  const int lowest = lowest_exponent(value);
  return Integer{static_cast<int64_t>(std::ldexp(double{value}, -lowest))} << (lowest - exponent);
}

Vector scaled(const float* values, int exponent) {
  return {scaled(values[0], exponent), scaled(values[1], exponent), scaled(values[2], exponent)};
}

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Integer dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The input as integers: points relative to the origin in units of 2^point_exponent, direction of
/// 2^direction_exponent.
struct IntegerTriangle {
  Vector point[3];
  Vector direction;
  int point_exponent, direction_exponent;

  /// direction . (p_i x p_j): the edge function times the direction's dominant component.
  Integer edge(int i, int j) const { return dot(cross(point[i], point[j]), direction); }
};

IntegerTriangle to_integers(const PreparedRay& ray, const TriangleCorners& corners) {
  IntegerTriangle out;
  int exponent = lowest_exponent(ray.origin);
  for (const float* vertex : corners.vertex) exponent = std::min(exponent, lowest_exponent(vertex));
  out.point_exponent = exponent == 1 << 20 ? 0 : exponent;
  out.direction_exponent = lowest_exponent(ray.direction);
  out.direction = scaled(ray.direction, out.direction_exponent);
  const Vector origin = scaled(ray.origin, out.point_exponent);
  for (int i = 0; i < 3; ++i) out.point[i] = scaled(corners.vertex[i], out.point_exponent) - origin;
  return out;
}

/// Sign of the sheared coordinate along `axis` of p_i - p_j, times the sign of the dominant component.
int coordinate_sign(const IntegerTriangle& triangle, int i, int j, uint32_t axis, uint32_t z) {
  const Vector p = triangle.point[i] - triangle.point[j];
  const Integer value = p[axis] * triangle.direction[z] - triangle.direction[axis] * p[z];
  return value.sign();
}

/// The nearest float to numerator / denominator * 2^exponent, ties to even. The denominator is not zero.
float nearest_float(Integer numerator, Integer denominator, int exponent) {
  if (numerator == 0) return 0;
  const bool negative = (numerator < 0) != (denominator < 0);
  numerator = abs(numerator);
  denominator = abs(denominator);
  // A quotient of 30 or 31 bits and one more for "not exact" below them decide any rounding to 24 bits or fewer.
  const int shift = 30 + static_cast<int>(msb(denominator)) - static_cast<int>(msb(numerator));
  if (shift > 0) numerator <<= shift;
  if (shift < 0) denominator <<= -shift;
  Integer quotient, remainder;
  divide_qr(numerator, denominator, quotient, remainder);
  const auto bits = static_cast<uint64_t>(quotient) << 1 | uint64_t{remainder != 0};
  const double value = std::ldexp(static_cast<double>(bits), exponent - shift - 1);
  return static_cast<float>(negative ? -value : value);
}

}  // namespace

ExactEdges exact_edges(const PreparedRay& ray, const TriangleCorners& corners) {
  const IntegerTriangle triangle = to_integers(ray, corners);
  const auto [kx, ky, kz] = ray.axis;
  const int z_sign = ray.direction[kz] < 0 ? -1 : 1;
  ExactEdges out;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    int sign = triangle.edge(i, j).sign();
    out.on_edge[i] = sign == 0;
    // The ray's point moves by (eps, eps^2): E_ij gains -eps (y_j - y_i) + eps^2 (x_j - x_i).
    if (sign == 0) sign = coordinate_sign(triangle, i, j, ky, kz);
    if (sign == 0) sign = coordinate_sign(triangle, j, i, kx, kz);
    out.sign[i] = sign * z_sign;
  }
  return out;
}

TriangleHit exact_hit(const PreparedRay& ray, const TriangleCorners& corners) {
  const IntegerTriangle triangle = to_integers(ray, corners);
  const Vector normal = cross(triangle.point[1] - triangle.point[0], triangle.point[2] - triangle.point[0]);
  const Integer determinant = dot(normal, triangle.direction);
  const int t_exponent = triangle.point_exponent - triangle.direction_exponent;
  return {nearest_float(dot(normal, triangle.point[0]), determinant, t_exponent),
          nearest_float(triangle.edge(2, 0), determinant, 0), nearest_float(triangle.edge(0, 1), determinant, 0),
          determinant < 0};
}

}  // namespace rayloom::accel
