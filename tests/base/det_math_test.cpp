#include <rayloom/base/det_math.h>

#include <rayloom/base/hash.h>

#include <catch2/catch.hpp>
#include <mpfr.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace rayloom;

namespace {

/// Distance of a result from the real value, in units in the last place of the real value's binade.
class Reference {
 public:
  Reference() { mpfr_inits2(200, x_, y_, result_, static_cast<mpfr_ptr>(nullptr)); }
  ~Reference() { mpfr_clears(x_, y_, result_, static_cast<mpfr_ptr>(nullptr)); }
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;

  using Unary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
  using Binary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

  template <typename T>
  double ulps(T computed, Unary function, T x) {
    mpfr_set_d(x_, static_cast<double>(x), MPFR_RNDN);
    function(result_, x_, MPFR_RNDN);
    return ulps_from_result(computed);
  }
  template <typename T>
  double ulps(T computed, Binary function, T x, T y) {
    mpfr_set_d(x_, static_cast<double>(x), MPFR_RNDN);
    mpfr_set_d(y_, static_cast<double>(y), MPFR_RNDN);
    function(result_, x_, y_, MPFR_RNDN);
    return ulps_from_result(computed);
  }

 private:
  template <typename T>
  static T rounded(mpfr_srcptr value) {
    if constexpr (std::is_same_v<T, float>) return mpfr_get_flt(value, MPFR_RNDN);
    return static_cast<T>(mpfr_get_d(value, MPFR_RNDN));
  }

  template <typename T>
  double ulps_from_result(T computed) {
    const T correct = rounded<T>(result_);
    if (std::isnan(correct) || std::isnan(computed)) return std::isnan(correct) == std::isnan(computed) ? 0 : INFINITY;
    if (correct == 0 && computed == 0) return std::signbit(correct) == std::signbit(computed) ? 0 : INFINITY;
    if (std::isinf(correct) || std::isinf(computed)) return near_overflow(correct, computed) ? 0 : INFINITY;
    const int exponent = std::max(std::ilogb(correct), std::numeric_limits<T>::min_exponent - 1);
    const int ulp_exponent =
        (correct == 0 ? std::numeric_limits<T>::min_exponent - 1 : exponent) - std::numeric_limits<T>::digits + 1;
    mpfr_set_d(x_, static_cast<double>(computed), MPFR_RNDN);
    mpfr_sub(result_, x_, result_, MPFR_RNDN);
    mpfr_mul_2si(result_, result_, -ulp_exponent, MPFR_RNDN);
    return std::abs(mpfr_get_d(result_, MPFR_RNDA));
  }

  /// SLEEF's double exp and pow overflow from exp(709.78271115) = (1 - 2e-6) max on; otherwise infinity and the largest
  /// number are neighbours.
  template <typename T>
  static bool near_overflow(T a, T b) {
    constexpr T largest = std::numeric_limits<T>::max() * (std::is_same_v<T, double> ? T(1 - 2e-6) : T(1));
    return std::signbit(a) == std::signbit(b) && std::abs(a) >= largest && std::abs(b) >= largest;
  }

  mpfr_t x_, y_, result_;
};

enum class Spread { bits, linear };

/// Numbers drawn by hashing: any bit pattern (so all exponents and denormals), or evenly from [low, high].
template <typename T>
struct Inputs {
  Spread spread = Spread::bits;
  double low = 0, high = 0;

  T operator()(uint64_t i, uint64_t stream) const {
    const uint64_t hash = hash64(i, stream);
    if (spread == Spread::linear) {
      return static_cast<T>(low + (high - low) * (static_cast<double>(hash >> 11) * 0x1p-53));
    }
    if constexpr (std::is_same_v<T, float>) return std::bit_cast<float>(static_cast<uint32_t>(hash));
    return static_cast<T>(std::bit_cast<double>(hash));
  }
};

template <typename T>
const std::vector<T>& special_values() {
  using Limits = std::numeric_limits<T>;
  static const std::vector<T> values = {T(0),
                                        T(-0.0),
                                        T(1),
                                        T(-1),
                                        T(0.5),
                                        T(-0.5),
                                        T(2),
                                        T(3),
                                        T(-3),
                                        T(10),
                                        T(1.5707963267948966),
                                        T(3.141592653589793),
                                        T(1e10),
                                        T(-1e22),
                                        Limits::min(),
                                        Limits::denorm_min(),
                                        -Limits::denorm_min(),
                                        Limits::max(),
                                        Limits::lowest(),
                                        Limits::epsilon(),
                                        T(1) - Limits::epsilon(),
                                        T(1) + Limits::epsilon(),
                                        Limits::infinity(),
                                        -Limits::infinity(),
                                        Limits::quiet_NaN()};
  return values;
}

constexpr uint64_t sample_count = 20'000;
constexpr double allowed_ulps = 1.0;
constexpr double allowed_ulps_denormal = 1.25;

/// Largest errors seen, apart for results in the normal range and those near or below its lower end.
template <typename T>
struct Worst {
  void add(double ulps, T result, T x, T y) {
    const bool denormal = std::abs(result) < 4 * std::numeric_limits<T>::min();
    double& largest = denormal ? ulps_denormal : ulps_normal;
    if (ulps <= largest) return;
    largest = ulps;
    where[denormal] = Catch::StringMaker<T>::convert(x) + ", " + Catch::StringMaker<T>::convert(y);
  }
  void check() const {
    INFO("arguments: " << where[0] << ", with a denormal result: " << where[1]);
    CHECK(ulps_normal <= allowed_ulps);
    CHECK(ulps_denormal <= allowed_ulps_denormal);
  }

  double ulps_normal = 0, ulps_denormal = 0;
  std::string where[2];
};

template <typename T>
void check_ulps(T (*function)(T) noexcept, Reference::Unary exact, const Inputs<T>& inputs) {
  Reference reference;
  Worst<T> worst;
  const auto add = [&](T x) { worst.add(reference.ulps(function(x), exact, x), function(x), x, T(0)); };
  for (uint64_t i = 0; i < sample_count; ++i) add(inputs(i, 1));
  for (const T x : special_values<T>()) add(x);
  worst.check();
}

template <typename T>
void check_ulps(T (*function)(T, T) noexcept, Reference::Binary exact, const Inputs<T>& first,
                const Inputs<T>& second) {
  Reference reference;
  Worst<T> worst;
  const auto add = [&](T x, T y) { worst.add(reference.ulps(function(x, y), exact, x, y), function(x, y), x, y); };
  for (uint64_t i = 0; i < sample_count; ++i) add(first(i, 1), second(i, 2));
  for (const T x : special_values<T>()) {
    for (const T y : special_values<T>()) add(x, y);
  }
  worst.check();
}

}  // namespace

TEMPLATE_TEST_CASE("deterministic functions of one number are within one ulp of the real value", "[det_math]", float,
                   double) {
  using T = TestType;
  struct Case {
    const char* name;
    T (*function)(T) noexcept;
    Reference::Unary exact;
    double low, high;
  };
  const Case cases[] = {
      {"sin", det::sin, mpfr_sin, -10, 10},    {"cos", det::cos, mpfr_cos, -10, 10},
      {"tan", det::tan, mpfr_tan, -10, 10},    {"asin", det::asin, mpfr_asin, -1, 1},
      {"acos", det::acos, mpfr_acos, -1, 1},   {"atan", det::atan, mpfr_atan, -10, 10},
      {"exp", det::exp, mpfr_exp, -110, 90},   {"exp2", det::exp2, mpfr_exp2, -150, 128},
      {"log", det::log, mpfr_log, 0, 3},       {"log2", det::log2, mpfr_log2, 0, 3},
      {"cbrt", det::cbrt, mpfr_cbrt, -10, 10},
  };
  for (const Case& c : cases) {
    DYNAMIC_SECTION(c.name) {
      check_ulps<T>(c.function, c.exact, Inputs<T>{Spread::linear, c.low, c.high});
      check_ulps<T>(c.function, c.exact, Inputs<T>{});
    }
  }
}

TEMPLATE_TEST_CASE("atan2 and pow are within one ulp of the real value", "[det_math]", float, double) {
  using T = TestType;
  const Inputs<T> any;
  check_ulps<T>(det::atan2, mpfr_atan2, Inputs<T>{Spread::linear, -2, 2}, Inputs<T>{Spread::linear, -2, 2});
  check_ulps<T>(det::atan2, mpfr_atan2, any, any);
  check_ulps<T>(det::pow, mpfr_pow, Inputs<T>{Spread::linear, 0, 4}, Inputs<T>{Spread::linear, -20, 20});
  check_ulps<T>(det::pow, mpfr_pow, any, any);
}

TEMPLATE_TEST_CASE("sincos equals sin and cos", "[det_math]", float, double) {
  using T = TestType;
  for (uint64_t i = 0; i < 1000; ++i) {
    const T x = Inputs<T>{Spread::linear, -100, 100}(i, 3);
    CHECK(det::sincos(x).sin == det::sin(x));
    CHECK(det::sincos(x).cos == det::cos(x));
  }
}

namespace {

template <typename T>
uint64_t hash_of_results() {
  using Function = T (*)(T) noexcept;
  constexpr Function functions[] = {det::sin, det::cos, det::tan, det::atan, det::exp, det::exp2, det::cbrt};
  Hash64 hash;
  const auto add = [&hash](T value) { hash.add(std::isnan(value) ? T(0.25) : value); };  // a NaN's sign is not defined
  for (uint64_t i = 0; i < 20'000; ++i) {
    const T any = Inputs<T>{}(i, 1);
    const T small = Inputs<T>{Spread::linear, -30, 30}(i, 2);
    const T unit = Inputs<T>{Spread::linear, -1, 1}(i, 3);
    for (const auto function : functions) add(function(any)), add(function(small));
    add(det::asin(unit)), add(det::acos(unit)), add(det::log(std::abs(small))), add(det::log2(std::abs(any)));
    add(det::atan2(small, unit)), add(det::pow(std::abs(small), unit)), add(det::pow(std::abs(any), small));
  }
  return hash.value();
}

}  // namespace

TEST_CASE("results have the same bits on every machine", "[det_math]") {
  CHECK(hash_of_results<float>() == 0x540311e056cf154a);
  CHECK(hash_of_results<double>() == 0xcc914debbbcb7317);
}
