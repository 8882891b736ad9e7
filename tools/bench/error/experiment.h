#pragma once

// Renders one scene in every configuration, at rising sample counts, with independent seeds.

#include <rayloom/tools/bench/error/reference_file.h>
#include <rayloom/tools/bench/error/series.h>

namespace rayloom::bench {

struct ErrorSettings {
  std::vector<uint32_t> spp{1, 4, 16, 64, 256};  ///< ascending
  uint32_t seeds = 8;
  uint64_t reference_spp = 0;
  uint32_t width = 64, height = 36;
  uint32_t max_bounces = 8;
  std::vector<Configuration> configurations;
};

/// The configurations take turns seed by seed, every other seed in reverse order, so that a change of the machine's
/// speed meets all of them. Throws Interrupted after Ctrl-C; a reference that was done by then is in the file.
SceneErrors measure_scene(const scenes::Scene& scene, const ErrorSettings& settings, ReferenceFile& references,
                          bool show_progress);

}  // namespace rayloom::bench
