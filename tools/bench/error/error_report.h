#pragma once

// The measurements as tables, charts, JSON and targets.

#include <rayloom/tools/bench/bench_report.h>
#include <rayloom/tools/bench/error/series.h>

#include <vector>

namespace rayloom::bench {

/// The relMSE whose times are told.
inline constexpr double error_targets[] = {0.1, 0.01, 0.001};

/// Bounds of --check. All configurations are unbiased: their MSE falls with a slope of -1 or steeper, and their mean is
/// the reference's.
inline constexpr double max_slope = -0.95, max_bias_sigmas = 5;

/// Above max_slope, but -1 is in the 95 % interval: the seeds do not agree well enough to tell, as where a few sparks
/// make most of the error. It is told, and misses nothing. A bias by itself is the same in all pictures, and its
/// interval narrow.
bool is_undetermined(const Estimate& mse_slope);

void add_results(BenchReport& report, const std::vector<SceneErrors>& scenes);

}  // namespace rayloom::bench
