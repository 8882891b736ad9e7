#pragma once

// Statistical tests shared by the shader tests. All thresholds are stated as significance levels.

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace rayloom::test {

/// Significance of one of `tests` independent tests so that all together have `alpha` (Sidak).
inline double sidak(double alpha, int tests) { return 1 - std::pow(1 - alpha, 1.0 / tests); }

/// Pearson's chi-square test: probability of a deviation at least this large. Cells expecting less than 5 are pooled
/// (cells expecting 0 that received something give p = 0).
inline double chi_square_p_value(std::span<const double> observed, std::span<const double> expected) {
  double statistic = 0, pooled_observed = 0, pooled_expected = 0;
  int cells = 0;
  for (size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] == 0 && observed[i] > 0) return 0;
    if (expected[i] < 5) {
      pooled_observed += observed[i], pooled_expected += expected[i];
      continue;
    }
    statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++cells;
  }
  if (pooled_expected >= 5) {
    statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    ++cells;
  }
  return cells < 2 ? 1 : boost::math::gamma_q(0.5 * (cells - 1), 0.5 * statistic);
}

/// Running mean and variance (Welford 1962).
struct Moments {
  double count = 0, mean = 0, sum_of_squares = 0;

  void add(double x) {
    const double delta = x - mean;
    mean += delta / ++count;
    sum_of_squares += delta * (x - mean);
  }
  double variance() const { return sum_of_squares / (count - 1); }
  double standard_error() const { return std::sqrt(variance() / count); }
};

/// Welch's t-test: probability that two sets of equal mean differ by at least this much.
inline double welch_p_value(const Moments& a, const Moments& b) {
  const double va = a.variance() / a.count, vb = b.variance() / b.count;
  if (va + vb == 0) return a.mean == b.mean ? 1 : 0;
  const double t = std::abs(a.mean - b.mean) / std::sqrt(va + vb);
  const double freedom = (va + vb) * (va + vb) / (va * va / (a.count - 1) + vb * vb / (b.count - 1));
  return 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), t));
}

}  // namespace rayloom::test
