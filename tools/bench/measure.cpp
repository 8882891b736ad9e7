#include <rayloom/tools/bench/measure.h>

#include <rayloom/base/progress.h>
#include <rayloom/tools/interrupt.h>

#include <algorithm>
#include <cassert>
#include <ctime>
#include <memory>

namespace rayloom::bench {

Spread spread_of(std::span<const double> values) {
  if (values.empty()) return {};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const size_t middle = sorted.size() / 2;
  const double median = sorted.size() % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
  return {sorted.front(), median, sorted.back()};
}

Spread ratio_of_pairs(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  std::vector<double> ratios;
  for (size_t i = 0; i < a.size(); ++i) ratios.push_back(a[i] / b[i]);
  return spread_of(ratios);
}

double now(Clock clock) {
  timespec time{};
  clock_gettime(clock == Clock::wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

std::vector<double> Measured::rates() const {
  std::vector<double> rates;
  for (const double s : seconds) rates.push_back(work / s);
  return rates;
}

Spread speed_ratio(const Measured& a, const Measured& b) { return ratio_of_pairs(a.rates(), b.rates()); }

std::vector<Measured> measure_interleaved(std::span<const Measurand> measurands, uint64_t repetitions, Clock clock,
                                          const std::string& label) {
  std::vector<Measured> results;
  for (const Measurand& measurand : measurands) results.push_back({measurand.name, {}, measurand.work});
  const uint64_t rounds = repetitions + 1;
  const auto progress = label.empty() ? nullptr : std::make_unique<Progress>(label, rounds * measurands.size(), "runs");
  for (uint64_t round = 0; round < rounds; ++round) {
    for (size_t k = 0; k < measurands.size(); ++k) {
      tools::throw_if_interrupted();
      const size_t i = round % 2 ? measurands.size() - 1 - k : k;
      const double begin = now(clock);
      measurands[i].run();
      const double seconds = now(clock) - begin;
      if (round > 0) results[i].seconds.push_back(seconds);
      if (progress) progress->advance();
    }
  }
  return results;
}

}  // namespace rayloom::bench
