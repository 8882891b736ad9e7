#include <rayloom/base/det_math.h>

#include <sleef.h>

namespace rayloom::det {

float sin(float x) noexcept { return Sleef_cinz_sinf1_u10purec(x); }
float cos(float x) noexcept { return Sleef_cinz_cosf1_u10purec(x); }
float tan(float x) noexcept { return Sleef_cinz_tanf1_u10purec(x); }
float asin(float x) noexcept { return Sleef_cinz_asinf1_u10purec(x); }
float acos(float x) noexcept { return Sleef_cinz_acosf1_u10purec(x); }
float atan(float x) noexcept { return Sleef_cinz_atanf1_u10purec(x); }
float exp(float x) noexcept { return Sleef_cinz_expf1_u10purec(x); }
float exp2(float x) noexcept { return Sleef_cinz_exp2f1_u10purec(x); }
float log(float x) noexcept { return Sleef_cinz_logf1_u10purec(x); }
float log2(float x) noexcept { return Sleef_cinz_log2f1_u10purec(x); }
float cbrt(float x) noexcept { return Sleef_cinz_cbrtf1_u10purec(x); }
float atan2(float y, float x) noexcept { return Sleef_cinz_atan2f1_u10purec(y, x); }
float pow(float base, float exponent) noexcept { return Sleef_cinz_powf1_u10purec(base, exponent); }
SinCos<float> sincos(float x) noexcept { return {sin(x), cos(x)}; }

double sin(double x) noexcept { return Sleef_cinz_sind1_u10purec(x); }
double cos(double x) noexcept { return Sleef_cinz_cosd1_u10purec(x); }
double tan(double x) noexcept { return Sleef_cinz_tand1_u10purec(x); }
double asin(double x) noexcept { return Sleef_cinz_asind1_u10purec(x); }
double acos(double x) noexcept { return Sleef_cinz_acosd1_u10purec(x); }
double atan(double x) noexcept { return Sleef_cinz_atand1_u10purec(x); }
double exp(double x) noexcept { return Sleef_cinz_expd1_u10purec(x); }
double exp2(double x) noexcept { return Sleef_cinz_exp2d1_u10purec(x); }
double log(double x) noexcept { return Sleef_cinz_logd1_u10purec(x); }
double log2(double x) noexcept { return Sleef_cinz_log2d1_u10purec(x); }
double cbrt(double x) noexcept { return Sleef_cinz_cbrtd1_u10purec(x); }
double atan2(double y, double x) noexcept { return Sleef_cinz_atan2d1_u10purec(y, x); }
double pow(double base, double exponent) noexcept { return Sleef_cinz_powd1_u10purec(base, exponent); }
SinCos<double> sincos(double x) noexcept { return {sin(x), cos(x)}; }

}  // namespace rayloom::det
