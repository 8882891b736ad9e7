#pragma once

// Every builder of ours and of Embree on one scene: what a build costs and what the tree gives.

#include <rayloom/tools/bench/bench_report.h>
#include <rayloom/tools/bench/bench_scene.h>
#include <rayloom/tools/bench/measure.h>

#include <optional>

namespace rayloom::bench {

/// Name of the row of lazy builds.
inline constexpr const char* lazy_builder = "lazy";

struct BuildOptions : BenchOptions {
  std::vector<std::string> scenes;
  std::string scenes_directory;
  bool against_embree = true;
  std::vector<unsigned> threads{1, 2};
  uint64_t repetitions = 5, size = 512;
  bool progress = true;
};

/// What only our trees tell.
struct TreeShape {
  double sah_cost = 0;
  uint32_t depth = 0;
  double children_per_node = 0;
};

/// A lazy build and the first rays through it.
struct LazyRun {
  double rays = 0;
  std::vector<double> seconds;  ///< to build, and to trace the rays, which builds parts; one a repetition
  uint64_t built_parts = 0;     ///< by these rays
};

struct BuildRow {
  std::string scene, builder;  ///< "binned_sah", "Embree high"
  bool ours = true;
  uint64_t triangles = 0;
  std::vector<std::pair<unsigned, Measured>> builds;  ///< by thread count
  std::optional<TreeShape> shape;
  uint64_t bytes = 0;
  Measured trace;  ///< bounce rays, closest hit, one thread: batches for us, rtcIntersect1 for Embree

  uint64_t parts = 0;              ///< of lazy structures
  std::vector<LazyRun> lazy_runs;  ///< by rising rays; empty for others

  const Measured* built_with(unsigned threads) const;
  /// Rays a second when `rays` are traced after one build, both on one thread.
  double effective_rate(double rays) const;
  /// What that takes. Lazy: as measured, and beyond the rays measured as if the next ray built all parts that are left.
  double seconds_for(double rays) const;
};

/// Where the graph has points, 10^4 to 10^9 rays.
std::vector<double> rays_per_build();

/// Builds and traces interleaved, round by round. std::runtime_error when trees of ours give different hits.
std::vector<BuildRow> run_builds(const std::string& scene, const BuildOptions& options);

}  // namespace rayloom::bench
