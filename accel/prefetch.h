#pragma once

#include <rayloom/accel/layout.h>

namespace rayloom::accel {

/// Asks for the lines of a child that will be visited, as many as a leaf has: a test takes less time than a line takes
/// to arrive. Lives outside the traversal's target-specific code so that every target can inline it.
struct Prefetch {
  const std::byte* block;
  void operator()(uint32_t ref) const {
    constexpr uint64_t line_bytes = 64;
    const std::byte* const child = block + node_ref::offset(ref);
    for (uint64_t line = 0; line < sizeof(TriangleLeaf8); line += line_bytes) __builtin_prefetch(child + line);
  }
};

}  // namespace rayloom::accel
