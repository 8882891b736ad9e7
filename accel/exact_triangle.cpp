#include <rayloom/accel/exact_triangle.h>

#include <boost/multiprecision/cpp_int.hpp>

#include <bit>
#include <cmath>

namespace rayloom::accel {
namespace {

namespace mp = boost::multiprecision;

// Width: a finite float is an integer multiple of 2^-149 below 2^128, hence 277 bits; a difference has 278; a
// determinant of two differences and a direction 278 + 278 + 277 + 3 = 836, and 838 the sum of three. A quotient is
// taken after shifting its numerator at most 31 bits past the denominator: 870.
using WideInteger = mp::number<mp::cpp_int_backend<896, 896, mp::signed_magnitude, mp::unchecked, void>, mp::et_off>;

// Enough when exponents differ little, as they do in most meshes: ten times faster.
__extension__ using NarrowInteger = __int128;

/// A nonzero float as mantissa * 2^exponent, the mantissa odd.
struct Parts {
  int64_t mantissa;
  int exponent, top;  ///< |value| < 2^top
};

Parts parts_of(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const int field = static_cast<int>(bits >> 23 & 0xFF);
  const uint32_t magnitude = (bits & 0x7FFFFF) | (field ? 0x800000u : 0u);
  const int exponent = (field ? field : 1) - 150, zeros = std::countr_zero(magnitude);
  const int64_t mantissa = magnitude >> zeros;
  return {value < 0 ? -mantissa : mantissa, exponent + zeros, exponent + static_cast<int>(std::bit_width(magnitude))};
}

/// The powers of two between which all bits of some floats lie.
struct BitRange {
  int lowest = 1 << 20, top = -(1 << 20);

  void include(const float* values) {
    for (int k = 0; k < 3; ++k) {
      if (values[k] == 0) continue;
      const Parts parts = parts_of(values[k]);
      lowest = std::min(lowest, parts.exponent);
      top = std::max(top, parts.top);
    }
  }
  int width() const { return std::max(0, top - lowest); }
};

struct InputRanges {
  BitRange points, direction;

  /// Bits of the sum of three determinants of two differences and the direction, or of three differences.
  int determinant_width() const {
    return 2 * (points.width() + 1) + std::max(points.width() + 1, direction.width()) + 5;
  }
};

InputRanges ranges_of(const PreparedRay& ray, const TriangleCorners& corners) {
  InputRanges out;
  out.points.include(ray.origin);
  for (const float* vertex : corners.vertex) out.points.include(vertex);
  out.direction.include(ray.direction);
  return out;
}

template <class Integer>
int sign_of(const Integer& value) {
  return value < 0 ? -1 : value > 0 ? 1 : 0;
}

/// values / 2^exponent, integers by choice of the exponent.
template <class Integer>
Vector3<Integer> scaled(const float* values, int exponent) {
  Vector3<Integer> out{};
  for (int k = 0; k < 3; ++k) {
    if (values[k] == 0) continue;
    const Parts parts = parts_of(values[k]);
    out[k] = Integer(parts.mantissa) << (parts.exponent - exponent);
  }
  return out;
}

/// The input as integers: points relative to the origin, and the direction, each in units of its lowest bit.
template <class Integer>
class IntegerTriangle {
 public:
  IntegerTriangle(const PreparedRay& ray, const TriangleCorners& corners, const InputRanges& ranges)
      : direction_(scaled<Integer>(ray.direction, ranges.direction.lowest)) {
    const Vector3<Integer> origin = scaled<Integer>(ray.origin, ranges.points.lowest);
    for (int i = 0; i < 3; ++i) point_[i] = scaled<Integer>(corners.vertex[i], ranges.points.lowest) - origin;
  }

  /// direction . (p_i x p_j): the edge function times the direction's dominant component.
  Integer edge(int i, int j) const { return dot(cross(point_[i], point_[j]), direction_); }

  /// Sign of the sheared coordinate along `axis` of p_i - p_j, times the sign of the dominant component.
  int coordinate_sign(int i, int j, uint32_t axis, uint32_t z) const {
    const Vector3<Integer> p = point_[i] - point_[j];
    return sign_of<Integer>(p[axis] * direction_[z] - direction_[axis] * p[z]);
  }

  Vector3<Integer> normal() const { return cross(point_[1] - point_[0], point_[2] - point_[0]); }
  const Vector3<Integer>& point(int i) const { return point_[i]; }
  const Vector3<Integer>& direction() const { return direction_; }

 private:
  Vector3<Integer> point_[3];
  Vector3<Integer> direction_;
};

template <class Integer>
ExactEdges edges_of(const PreparedRay& ray, const IntegerTriangle<Integer>& triangle) {
  const auto [kx, ky, kz] = ray.axis;
  const int z_sign = ray.direction[kz] < 0 ? -1 : 1;
  ExactEdges out;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    int sign = sign_of(triangle.edge(i, j));
    out.on_edge[i] = sign == 0;
    // The ray's point moves by (eps, eps^2): E_ij gains -eps (y_j - y_i) + eps^2 (x_j - x_i).
    if (sign == 0) sign = triangle.coordinate_sign(i, j, ky, kz);
    if (sign == 0) sign = triangle.coordinate_sign(j, i, kx, kz);
    out.sign[i] = sign * z_sign;
  }
  return out;
}

/// The nearest float to numerator / denominator * 2^exponent, ties to even; NaN for a zero denominator.
float nearest_float(WideInteger numerator, WideInteger denominator, int exponent) {
  if (denominator == 0) return std::numeric_limits<float>::quiet_NaN();
  if (numerator == 0) return 0;
  const bool negative = (numerator < 0) != (denominator < 0);
  numerator = abs(numerator);
  denominator = abs(denominator);
  // A quotient of 30 or 31 bits and one more for "not exact" below them decide any rounding to 24 bits or fewer.
  const int shift = 30 + static_cast<int>(msb(denominator)) - static_cast<int>(msb(numerator));
  if (shift > 0) numerator <<= shift;
  if (shift < 0) denominator <<= -shift;
  WideInteger quotient, remainder;
  divide_qr(numerator, denominator, quotient, remainder);
  const auto bits = static_cast<uint64_t>(quotient) << 1 | uint64_t{remainder != 0};
  const double value = std::ldexp(static_cast<double>(bits), exponent - shift - 1);
  return static_cast<float>(negative ? -value : value);
}

template <class Integer>
void divide(const IntegerTriangle<Integer>& triangle, const InputRanges& ranges, const QuotientChoice& chosen,
            TriangleHit& hit) {
  const Vector3<Integer> normal = triangle.normal();
  const WideInteger determinant = dot(normal, triangle.direction());
  const int t_exponent = ranges.points.lowest - ranges.direction.lowest;
  if (chosen.t) hit.t = nearest_float(dot(normal, triangle.point(0)), determinant, t_exponent);
  if (chosen.u) hit.u = nearest_float(triangle.edge(2, 0), determinant, 0);
  if (chosen.v) hit.v = nearest_float(triangle.edge(0, 1), determinant, 0);
  hit.front = determinant < 0;
}

/// Calls `action` with the triangle in the narrowest integers that hold its determinants.
template <class Action>
auto with_integers(const PreparedRay& ray, const TriangleCorners& corners, const Action& action) {
  const InputRanges ranges = ranges_of(ray, corners);
  if (ranges.determinant_width() <= 126) return action(IntegerTriangle<NarrowInteger>(ray, corners, ranges), ranges);
  return action(IntegerTriangle<WideInteger>(ray, corners, ranges), ranges);
}

}  // namespace

ExactEdges exact_edges(const PreparedRay& ray, const TriangleCorners& corners) {
  return with_integers(ray, corners, [&](const auto& triangle, const InputRanges&) { return edges_of(ray, triangle); });
}

void exact_quotients(const PreparedRay& ray, const TriangleCorners& corners, const QuotientChoice& chosen,
                     TriangleHit& hit) {
  with_integers(ray, corners,
                [&](const auto& triangle, const InputRanges& ranges) { divide(triangle, ranges, chosen, hit); });
}

}  // namespace rayloom::accel
