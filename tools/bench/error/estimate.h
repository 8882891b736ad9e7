#pragma once

// Numbers with their uncertainty over independent seeds.

#include <functional>
#include <span>
#include <vector>

namespace rayloom::bench {

/// A value and its standard error; `count` seeds stand behind it.
struct Estimate {
  double value = 0, standard_error = 0;
  size_t count = 0;

  /// Half the width of the 95 % confidence interval (Student's t, count - 1 degrees of freedom). Infinite below two.
  double half_width() const;
  double low() const { return value - half_width(); }
  double high() const { return value + half_width(); }
};

/// The mean of independent values.
Estimate mean_of(std::span<const double> values);

/// Any function of the seeds' measurements. The value is that of all of them, the standard error the jackknife's (Efron
/// and Stein 1981): `f` is given the indices of the seeds to use, first all, then all but one. At least two seeds.
Estimate jackknife(size_t seeds, const std::function<double(std::span<const size_t>)>& f);

/// Slope of the least-squares line through (log x, log y). At least two points, all positive; NaN otherwise.
double log_log_slope(std::span<const double> x, std::span<const double> y);

}  // namespace rayloom::bench
