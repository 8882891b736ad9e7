#include <rayloom/tools/bench/error/estimate.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace rayloom::bench;

TEST_CASE("a mean has the standard error and the t interval of the textbook") {
  // 1..8: mean 4.5, variance 6, t(7 degrees, 0.975) = 2.364624.
  const Estimate mean = mean_of(std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8});
  CHECK(mean.value == Approx(4.5));
  CHECK(mean.standard_error == Approx(std::sqrt(6.0 / 8)));
  CHECK(mean.half_width() == Approx(2.364624 * std::sqrt(6.0 / 8)).epsilon(1e-6));
  CHECK(mean.low() == Approx(4.5 - mean.half_width()));
  CHECK(std::isinf(mean_of(std::vector<double>{3}).half_width()));
}

TEST_CASE("the jackknife of a mean is the mean's own standard error") {
  const std::vector<double> values{3, 1, 4, 1, 5, 9, 2, 6};
  const Estimate direct = mean_of(values);
  const Estimate jackknifed = jackknife(values.size(), [&](std::span<const size_t> seeds) {
    double sum = 0;
    for (const size_t i : seeds) sum += values[i];
    return sum / static_cast<double>(seeds.size());
  });
  CHECK(jackknifed.value == Approx(direct.value));
  CHECK(jackknifed.standard_error == Approx(direct.standard_error));
}

TEST_CASE("a power law has its exponent as slope") {
  const std::vector<double> x{1, 4, 16, 64};
  std::vector<double> y;
  for (const double v : x) y.push_back(7 * std::pow(v, -1.25));
  CHECK(log_log_slope(x, y) == Approx(-1.25));
  CHECK(log_log_slope(std::vector<double>{1, 2, 4}, std::vector<double>{1, 2, 1}) == Approx(0).margin(1e-12));
  CHECK(std::isnan(log_log_slope(std::vector<double>{1, 2}, std::vector<double>{1, -1})));
}
