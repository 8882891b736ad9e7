#pragma once

// The rows of the traversal table, what is required of them, and how they are told.

#include <rayloom/tools/bench/bench_report.h>
#include <rayloom/tools/bench/traversal/contest.h>
#include <rayloom/tools/bench/traversal/dispatch.h>

#include <optional>

namespace rayloom::bench {

/// How fast one peer answered the same rays.
struct PeerRow {
  std::string peer;  ///< "high", "high robust"
  Spread rate;       ///< rays a second
  Spread ratio;      ///< ours over theirs
  Differences differences;
  double instructions_per_ray = 0;  ///< 0: not counted
};

struct TraversalRow {
  std::string scene, set, mode, peer_call;
  unsigned threads = 1;
  uint64_t rays = 0;
  double hit_share = 0;
  Spread rate;  ///< rays a second
  std::vector<PeerRow> peers;
  double instructions_per_ray = 0;  ///< 0: not counted
};

/// Bytes of everything that tracing needs, beside the caller's vertices and indices.
struct MemoryRow {
  std::string scene, structure;  ///< "ours", "ours, MINIMIZE_MEMORY", "Embree high"
  uint64_t triangles = 0, bytes = 0;
  std::optional<Spread> speed;  ///< of MINIMIZE_MEMORY's bounce rays over those of full speed

  double bytes_per_triangle() const { return static_cast<double>(bytes) / static_cast<double>(triangles); }
};

/// Where the time of a primary ray through TraceRay goes.
struct BreakdownRow {
  std::string scene;
  unsigned threads = 1;
  DispatchBreakdown ns;
};

/// A bound of the traversal table: over scenes, the median ratio to a peer, and the smallest.
struct SpeedTarget {
  const char* set;
  const char* mode;
  const char* peer;
  double median, smallest;  ///< smallest 0: none
};

inline constexpr const char* batch_mode = "batch";
inline constexpr const char* warp_mode = "batch of 32";
inline constexpr const char* single_mode = "one at a time";
inline constexpr const char* dispatch_mode = "TraceRay in a shader";

void add_rows(BenchReport& report, const std::vector<TraversalRow>& rows);
void add_breakdowns(BenchReport& report, const std::vector<BreakdownRow>& rows);
void add_memory(BenchReport& report, const std::vector<MemoryRow>& rows);

/// Targets of every thread count that has rows against the peer, and of memory.
void add_targets(Targets& targets, const std::vector<TraversalRow>& rows, const std::vector<MemoryRow>& memory);

}  // namespace rayloom::bench
