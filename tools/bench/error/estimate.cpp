#include <rayloom/tools/bench/error/estimate.h>

#include <cmath>
#include <limits>
#include <numeric>

#include <boost/math/distributions/students_t.hpp>

namespace rayloom::bench {

double Estimate::half_width() const {
  if (count < 2) return std::numeric_limits<double>::infinity();
  const boost::math::students_t distribution(static_cast<double>(count - 1));
  return boost::math::quantile(distribution, 0.975) * standard_error;
}

Estimate mean_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  if (values.empty()) return {};
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, values.size() < 2 ? 0 : std::sqrt(squares / (n * (n - 1))), values.size()};
}

Estimate jackknife(size_t seeds, const std::function<double(std::span<const size_t>)>& f) {
  std::vector<size_t> all(seeds);
  std::iota(all.begin(), all.end(), size_t{0});
  std::vector<double> without;
  for (size_t left_out = 0; left_out < seeds; ++left_out) {
    std::vector<size_t> rest = all;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left_out));
    without.push_back(f(rest));
  }
  const Estimate spread = mean_of(without);
  return {f(all), spread.standard_error * static_cast<double>(seeds - 1), seeds};
}

double log_log_slope(std::span<const double> x, std::span<const double> y) {
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(x.size());
  for (size_t i = 0; i < x.size(); ++i) mean_x += std::log(x[i]) / n, mean_y += std::log(y[i]) / n;
  for (size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x;
    xx += dx * dx, xy += dx * (std::log(y[i]) - mean_y);
  }
  return xy / xx;
}

}  // namespace rayloom::bench
