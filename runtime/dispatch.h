#pragma once

// How a recorded dispatch is to run, and what it did.

#include <rayloom/runtime/tracer.h>

#include <cstdint>
#include <string_view>
#include <vector>

namespace rayloom {

/// Warp: lanes run on fibers, and the rays they wait for are traced as one batch. Direct: lanes run one after another
/// and trace each ray at once. Same results, same bits. Automatic: direct for pipelines declared with recursion depth 0
/// (they trace nothing) and for warps of one lane, unless a tracer is given; else warp.
enum class ExecutionMode : uint8_t { automatic, warp, direct };

struct DispatchOptions {
  ExecutionMode mode = ExecutionMode::automatic;
  uint32_t warp_size = 32;         ///< 1..64 lanes; without a tracer twice as many are under way at a time
  Tracer* tracer = nullptr;        ///< null: the native one
  uint64_t fiber_stack_bytes = 0;  ///< 0: from the pipeline stack size, at least 256 KiB
};

/// Counts are exact and the same for any thread count, warp size and mode.
struct DispatchStatistics {
  uint64_t rays = 0;  ///< TraceRay calls
  uint64_t hits = 0;  ///< of which committed a hit
  uint64_t ray_generation = 0, intersection = 0, any_hit = 0, closest_hit = 0, miss = 0, callable = 0;  ///< invocations

  DispatchStatistics& operator+=(const DispatchStatistics& other);
  friend bool operator==(const DispatchStatistics&, const DispatchStatistics&) = default;
};

struct DispatchReport {
  std::string_view skipped_by;  ///< the rule by which nothing ran (DR-02, DR-03, DR-06, ST-02); empty: it ran
  ExecutionMode mode = ExecutionMode::direct;  ///< the one used
  uint32_t warp_size = 0;
  uint64_t warps = 0;
  DispatchStatistics statistics;
};

struct ExecutionReport {
  std::vector<DispatchReport> dispatches;  ///< in order of recording
};

}  // namespace rayloom
