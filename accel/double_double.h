#pragma once

// Numbers of about 106 bits as unevaluated sums of two doubles (Dekker 1971), without fused operations, so that they
// are fast and equal on every CPU. Valid where nothing overflows or underflows, which the users of this file have to
// show.

#include <bit>
#include <cstdint>

namespace rayloom::accel {

/// high + low, |low| <= 2^-53 |high|.
struct DoubleDouble {
  double high = 0, low = 0;
};

/// Relative error of one operation. For a sum it is relative to the sum of the absolute values; proofs:
/// docs/numerics.md, "Double-double".
inline constexpr double double_double_unit = 0x1p-102;

/// a + b without error (Knuth).
inline DoubleDouble exact_sum(double a, double b) {
  const double sum = a + b, from_b = sum - a;
  return {sum, (a - (sum - from_b)) + (b - from_b)};
}

/// a * b without error (Dekker, Veltkamp).
inline DoubleDouble exact_product(double a, double b) {
  const auto upper_half = [](double x) {
    const double wide = 0x8000001p0 * x;
    return wide - (wide - x);
  };
  const double product = a * b;
  const double a1 = upper_half(a), a2 = a - a1, b1 = upper_half(b), b2 = b - b1;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = exact_sum(a.high, b.high);
  return exact_sum(high.high, high.low + (a.low + b.low));
}

inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = exact_product(a.high, b.high);
  return exact_sum(high.high, high.low + (a.high * b.low + a.low * b.high));
}

/// Relative error at most 2 double_double_unit. The remainder of the leading quotient gives the next 53 bits.
inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double leading = a.high / b.high;
  const DoubleDouble remainder = a - DoubleDouble{leading} * b;
  return exact_sum(leading, remainder.high / b.high);
}

/// The float nearest to high + low, ties to even. Rounding to odd in double first leaves the second rounding the
/// information it needs (Boldo and Melquiond 2008).
inline float nearest_float(const DoubleDouble& value) {
  auto bits = std::bit_cast<uint64_t>(value.high);
  if (value.low != 0 && (bits & 1) == 0) bits += (value.low > 0) == (value.high > 0) ? 1 : ~uint64_t{0};
  return static_cast<float>(std::bit_cast<double>(bits));
}

}  // namespace rayloom::accel
