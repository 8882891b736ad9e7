#pragma once

// What each feature of traversal costs in instructions, where a scene does not use it and where it does.

#include <rayloom/tools/bench/bench_report.h>

namespace rayloom::bench {

struct FeatureOptions {
  std::string scene, scenes_directory;
  uint64_t size = 32;  ///< side of the picture whose bounce rays are traced
};

/// In the child, under callgrind: every variant of every feature, and prints how many rays each traced.
void count_features(const FeatureOptions& options);

/// In the parent: runs the child and adds the table; its targets: what is not used costs no instruction.
void add_features(BenchReport& report, const FeatureOptions& options);

}  // namespace rayloom::bench
