#pragma once

// Run time against error, a point a tracer: nanoseconds a ray against false misses of rays aimed at edges, and against
// the error of t.

#include <rayloom/tools/bench/bench_report.h>

namespace rayloom::bench::numerics {

struct ParetoOptions {
  uint64_t edge_rays = 1000000;  ///< a scene, aimed at edges
  uint64_t timed_rays = 100000;  ///< a scene and repetition, in random directions
  uint64_t exact_rays = 20000;   ///< a scene, whose t is compared with rationals
  uint64_t repetitions = 7;
  uint64_t seed = 1;
  std::string mesh;  ///< only this one; empty: all
};

/// Measures ours (one ray at a time, batches) and, where it is installed, Embree (fast, robust, compact) on closed
/// meshes seen from inside, where every miss is false. Adds tables and charts.
void add_pareto(BenchReport& report, const ParetoOptions& options);

}  // namespace rayloom::bench::numerics
