#pragma once

// A second exact oracle, in integers (GMP): a finite float is a whole number of 2^-149. It shares no code and no
// formula with accel or with rational_oracle.h: nothing is projected or divided, the symbolic shift is expanded in the
// determinants, and rounding is done here.

#include <rayloom/accel/ray.h>

#include <gmpxx.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace rayloom::accel::test {

using Integer3 = std::array<mpz_class, 3>;

/// x in units of 2^-149.
inline mpz_class in_units(float x) { return mpz_class(std::ldexp(double{x}, 149)); }

inline Integer3 in_units(const float* p) { return {in_units(p[0]), in_units(p[1]), in_units(p[2])}; }

inline Integer3 difference(const Integer3& a, const Integer3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

inline Integer3 cross(const Integer3& a, const Integer3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline mpz_class dot(const Integer3& a, const Integer3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The float nearest to numerator / denominator, ties to even; infinite where it is too large.
inline float nearest_float(mpz_class numerator, mpz_class denominator) {
  const bool negative = sgn(numerator) * sgn(denominator) < 0;
  numerator = abs(numerator);
  denominator = abs(denominator);
  if (numerator == 0) return 0;
  const auto bits = [](const mpz_class& x) { return static_cast<int>(mpz_sizeinbase(x.get_mpz_t(), 2)); };
  int exponent = std::max(bits(numerator) - bits(denominator) - 24, -149);  // of the last place, or one too small
  const auto shift = [](mpz_class& x, int by) { x <<= static_cast<unsigned>(by); };
  exponent > 0 ? shift(denominator, exponent) : shift(numerator, -exponent);
  mpz_class whole = numerator / denominator;
  if (bits(whole) > 24) {
    shift(denominator, 1);
    ++exponent;
    whole = numerator / denominator;
  }
  const mpz_class twice_rest = 2 * (numerator - whole * denominator);
  const int half = cmp(twice_rest, denominator);
  if (half > 0 || (half == 0 && mpz_odd_p(whole.get_mpz_t()))) ++whole;
  const double value = std::ldexp(whole.get_d(), exponent);
  const float rounded = value >= 0x1p128 ? std::numeric_limits<float>::infinity() : static_cast<float>(value);
  return negative ? -rounded : rounded;
}

/// The directions and corners of one test, relative to the ray's origin.
struct IntegerTest {
  Integer3 d, p[3];
  int kx, ky, kz;

  IntegerTest(const Ray& ray, const std::array<std::array<float, 3>, 3>& triangle) : d(in_units(ray.direction)) {
    const Integer3 o = in_units(ray.origin);
    for (int i = 0; i < 3; ++i) p[i] = difference(in_units(triangle[i].data()), o);
    kz = 0;
    for (int k = 1; k < 3; ++k)
      if (cmpabs(d[k], d[kz]) > 0) kz = k;
    kx = (kz + 1) % 3;
    ky = (kz + 2) % 3;
  }

  static int cmpabs(const mpz_class& a, const mpz_class& b) { return mpz_cmpabs(a.get_mpz_t(), b.get_mpz_t()); }

  /// d . (p_i x p_j), the edge function times d[kz].
  mpz_class edge(int i, int j) const { return dot(d, cross(p[i], p[j])); }

  /// Sign of d . ((p_i - s) x (p_j - s)) for s = (e, e^2) along kx and ky: its first coefficient that is not zero.
  int sign(int i, int j) const {
    const Integer3 w = difference(p[j], p[i]);
    const mpz_class coefficients[] = {edge(i, j), d[ky] * w[kz] - d[kz] * w[ky], d[kz] * w[kx] - d[kx] * w[kz]};
    for (const mpz_class& c : coefficients)
      if (sgn(c) != 0) return sgn(c);
    return 0;
  }
};

/// A hit of the line, its numbers rounded to the nearest floats.
struct IntegerHit {
  float t, u, v;
  bool front;
};

/// For finite corners and a finite direction that is not zero. t may be negative or infinite: limits are the caller's.
inline std::optional<IntegerHit> integer_hit(const Ray& ray, const std::array<std::array<float, 3>, 3>& triangle) {
  const IntegerTest test(ray, triangle);
  const int sign = test.sign(0, 1);
  if (sign == 0 || test.sign(1, 2) != sign || test.sign(2, 0) != sign) return std::nullopt;
  const Integer3 n = cross(difference(test.p[1], test.p[0]), difference(test.p[2], test.p[0]));
  const mpz_class area = dot(n, test.d);
  return IntegerHit{nearest_float(dot(n, test.p[0]), area), nearest_float(test.edge(2, 0), area),
                    nearest_float(test.edge(0, 1), area), sgn(area) < 0};
}

}  // namespace rayloom::accel::test
