#pragma once

// One set of rays, traced by us in several ways and by the peers in one, interleaved in the same run.

#include <rayloom/tools/bench/measure.h>
#include <rayloom/tools/bench/oracle.h>
#include <rayloom/tools/bench/ray_sets.h>
#include <rayloom/tools/bench/traced_rays.h>

namespace rayloom::bench {

struct Contestant {
  std::string name;
  TraceRays trace;
  /// Set where `trace` takes the set only as a whole and keeps its hits: gets them afterwards, outside the timing.
  std::function<std::vector<accel::Hit>()> collect = {};
};

struct Contest {
  std::string set, peer_call;
  const Rays* rays = nullptr;
  bool any_hit = false;
  std::vector<Contestant> ours, peers;
};

/// How answers differ from a peer's, each difference judged by the oracle.
struct Differences {
  uint64_t total = 0, ours_exact = 0, theirs_exact = 0, ties = 0, undecided = 0;
};

struct ContestResult {
  std::vector<Measured> ours, peers;  ///< in the contest's order
  double hit_share = 0;
  uint64_t disagreeing_modes = 0;        ///< rays to which our own ways give different answers: always 0
  std::vector<Differences> differences;  ///< of our first way with each peer
};

struct ContestSettings {
  unsigned threads = 1;  ///< 1: CPU time of the calling thread; more: wall time
  uint64_t repetitions = 5;
  bool progress = false;
};

/// `peers`: those of the contest, asked for their closest hits where any-hit answers, which name no triangle, differ.
ContestResult run_contest(const Contest& contest, const BenchScene& scene, const OurStructure& structure,
                          std::span<const std::unique_ptr<Peer>> peers, const ContestSettings& settings);

}  // namespace rayloom::bench
