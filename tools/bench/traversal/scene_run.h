#pragma once

// Everything the traversal bench measures in one scene.

#include <rayloom/tools/bench/traversal/rows.h>

namespace rayloom::bench {

struct TraversalOptions : BenchOptions {
  std::vector<std::string> scenes;
  std::string scenes_directory;
  bool against_embree = false;
  bool avx2 = false;  ///< for us and the peers
  std::vector<unsigned> threads{1, 2};
  uint64_t repetitions = 5, size = 512, batch = usual_batch;
  uint64_t largest_flat = flatten_limit;
  bool instructions = false;   ///< count them beside the times
  uint64_t counted_size = 48;  ///< side of the picture for that
  bool progress = true;
};

struct SceneResult {
  std::vector<TraversalRow> rows;
  std::vector<MemoryRow> memory;
  std::vector<BreakdownRow> breakdowns;
};

SceneResult run_scene(const std::string& name, const TraversalOptions& options);

/// In the child, under callgrind: counts every way and peer of every set in the first scene named, and prints how many
/// rays each traced.
void count_scene(const TraversalOptions& options);

}  // namespace rayloom::bench
