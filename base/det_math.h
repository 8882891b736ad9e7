#pragma once

// Elementary functions with the same bits on every machine (guarantee G3a). libm picks its code by CPU, so its last bit
// does too; these are SLEEF's deterministic scalar functions (the Sleef_cinz_* family: no FMA, no dispatch).
// Square root, fma, floor and friends are exact in IEEE 754: take them from <cmath>.

namespace rayloom::det {

template <typename T>
struct SinCos {
  T sin, cos;
};

// Each result is within 1 ulp of the real value over the whole range of the type, and within 1.25 where it is below
// four times the smallest normal number (SLEEF's u10 family; det_math_test.cpp measures it against MPFR), with the
// special values of C's Annex F. The double exp and pow overflow to infinity a little early, from 2e-6 below the
// largest number. sincos(x) is {sin(x), cos(x)}.
float sin(float radians) noexcept;
float cos(float radians) noexcept;
SinCos<float> sincos(float radians) noexcept;
float tan(float radians) noexcept;
float asin(float x) noexcept;
float acos(float x) noexcept;
float atan(float x) noexcept;
float atan2(float y, float x) noexcept;
float exp(float x) noexcept;
float exp2(float x) noexcept;
float log(float x) noexcept;
float log2(float x) noexcept;
float pow(float base, float exponent) noexcept;
float cbrt(float x) noexcept;

double sin(double radians) noexcept;
double cos(double radians) noexcept;
SinCos<double> sincos(double radians) noexcept;
double tan(double radians) noexcept;
double asin(double x) noexcept;
double acos(double x) noexcept;
double atan(double x) noexcept;
double atan2(double y, double x) noexcept;
double exp(double x) noexcept;
double exp2(double x) noexcept;
double log(double x) noexcept;
double log2(double x) noexcept;
double pow(double base, double exponent) noexcept;
double cbrt(double x) noexcept;

}  // namespace rayloom::det
