#include <rayloom/tools/bench/error/series.h>

#include <cmath>

namespace rayloom::bench {
namespace {

using Get = double (*)(const Measurement&);

double get_mse(const Measurement& m) { return m.error.mse; }
double get_relmse(const Measurement& m) { return m.error.relmse; }
double get_trimmed_relmse(const Measurement& m) { return m.error.trimmed_relmse; }
double get_flip(const Measurement& m) { return m.flip.ldr; }

double mean_over(const ErrorCurve& curve, size_t i, std::span<const size_t> seeds, Get get) {
  double sum = 0;
  for (const size_t seed : seeds) sum += get(curve.seeds[seed][i]);
  return sum / static_cast<double>(seeds.size());
}

Estimate slope(const ErrorCurve& curve, Get get) {
  const std::vector<double> spp(curve.spp.begin(), curve.spp.end());
  return jackknife(curve.seeds.size(), [&](std::span<const size_t> seeds) {
    std::vector<double> errors;
    for (size_t i = 0; i < spp.size(); ++i) errors.push_back(mean_over(curve, i, seeds, get));
    return log_log_slope(spp, errors);
  });
}

std::vector<double> last_seconds(const ErrorCurve& curve) {
  std::vector<double> seconds;
  for (const auto& seed : curve.seeds) seconds.push_back(seed.back().seconds);
  return seconds;
}

}  // namespace

Estimate ErrorCurve::mse(size_t i) const { return mean(i, get_mse); }
Estimate ErrorCurve::relmse(size_t i) const { return mean(i, get_relmse); }
Estimate ErrorCurve::trimmed_relmse(size_t i) const { return mean(i, get_trimmed_relmse); }

Spread ErrorCurve::seconds(size_t i) const {
  std::vector<double> values;
  for (const auto& seed : seeds) values.push_back(seed[i].seconds);
  return spread_of(values);
}

Estimate mse_slope(const ErrorCurve& curve) { return slope(curve, get_mse); }
Estimate relmse_slope(const ErrorCurve& curve) { return slope(curve, get_relmse); }

TimeToError time_to_relmse(const ErrorCurve& curve, double target) {
  const auto point = [&](size_t i) {
    return TimeToError{TimeToError::Kind::within, curve.seconds(i).median, static_cast<double>(curve.spp[i])};
  };
  const auto error = [&](size_t i) { return curve.relmse(i).value; };
  if (error(0) <= target) {
    TimeToError first = point(0);
    first.kind = TimeToError::Kind::before_first;
    return first;
  }
  for (size_t i = 1; i < curve.spp.size(); ++i) {
    if (!(error(i) <= target)) continue;
    const double above = std::log(error(i - 1)), below = std::log(std::max(error(i), 1e-300));
    const double share = (above - std::log(target)) / (above - below);
    const TimeToError a = point(i - 1), b = point(i);
    return {TimeToError::Kind::within, a.seconds * std::pow(b.seconds / a.seconds, share),
            a.spp * std::pow(b.spp / a.spp, share)};
  }
  TimeToError last = point(curve.spp.size() - 1);
  last.kind = TimeToError::Kind::after_last;
  return last;
}

CurveRatio compare(const ErrorCurve& curve, const ErrorCurve& base) {
  const size_t last = curve.spp.size() - 1, seeds = curve.seeds.size();
  const auto ratio_of = [&](Get get) {
    return [&curve, &base, get, last](std::span<const size_t> chosen) {
      return mean_over(curve, last, chosen, get) / mean_over(base, last, chosen, get);
    };
  };
  CurveRatio ratio;
  ratio.time = ratio_of_pairs(last_seconds(curve), last_seconds(base));
  const auto efficiency_of = [&](Get get) {
    return jackknife(seeds, [error = ratio_of(get), time = ratio.time.median](std::span<const size_t> chosen) {
      return 1 / (error(chosen) * time);
    });
  };
  ratio.mse = jackknife(seeds, ratio_of(get_mse));
  ratio.relmse = jackknife(seeds, ratio_of(get_relmse));
  ratio.trimmed_relmse = jackknife(seeds, ratio_of(get_trimmed_relmse));
  ratio.flip = jackknife(seeds, ratio_of(get_flip));
  ratio.mse_efficiency = efficiency_of(get_mse);
  ratio.trimmed_efficiency = efficiency_of(get_trimmed_relmse);
  return ratio;
}

}  // namespace rayloom::bench
