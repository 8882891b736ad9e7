#pragma once

// The same rays through the whole runtime: TraceRay in a ray generation shader, a closest-hit shader that tells the
// hit, a miss shader; and the same again with parts left out, so that each part's cost is a difference.

#include <rayloom/tools/bench/bench_scene.h>
#include <rayloom/tools/bench/measure.h>
#include <rayloom/tools/bench/ray_sets.h>

#include <memory>

namespace rayloom::bench {

/// What a run of the program leaves out.
enum class DispatchPart {
  launch,    ///< the ray generation shader does not call TraceRay
  switches,  ///< rays are gathered but not traced: all miss, into a null record
  lookup,    ///< hits are those of an earlier run; their records have no closest-hit shader
  shaders,   ///< and now they have: only tracing is missing
  whole,
};

class DispatchBench {
 public:
  /// `validated`: with the validation layer on.
  DispatchBench(const BenchScene& scene, const Rays& rays, bool validated = false);
  ~DispatchBench();

  void run(DispatchPart part);
  /// What the last whole run found, a hit a ray.
  std::vector<accel::Hit> hits() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Nanoseconds a ray and thread, each the median of what a part adds to the one before.
struct DispatchBreakdown {
  double launch = 0, switches = 0, lookup = 0, closest_hit = 0, trace = 0, total = 0;
};
DispatchBreakdown measure_breakdown(DispatchBench& bench, size_t rays, unsigned threads, uint64_t repetitions);

}  // namespace rayloom::bench
