#pragma once

// Our ways of tracing many rays.

#include <rayloom/tools/bench/our_structure.h>

#include <functional>

namespace rayloom::bench {

/// Traces rays into hits; must take any part of a set, from any thread.
using TraceRays = std::function<void(std::span<const accel::Ray>, std::span<accel::Hit>)>;

inline constexpr size_t usual_batch = 4096;

/// accel's batch API, `batch` rays a call; any-hit rays are only told whether they hit, in Hit::type.
TraceRays trace_in_batches(const OurStructure& structure, uint32_t ray_flags, size_t batch);
/// One call a ray.
TraceRays trace_one_by_one(const OurStructure& structure, uint32_t ray_flags);

/// In parts that depend on the set alone, over `threads` threads (1: the calling one, as a whole).
void trace_all(const TraceRays& trace, std::span<const accel::Ray> rays, std::span<accel::Hit> hits, unsigned threads);

}  // namespace rayloom::bench
