#pragma once

#include <rayloom/accel/layout.h>

namespace rayloom::accel {

/// Asks for the lines of a child that will be visited: a test takes less time than a line takes to arrive. Lives
/// outside the traversal's target-specific code so that every target can inline it.
struct Prefetch {
  const std::byte* block;
  /// Inlined at once: GCC takes a function that only prefetches for one without effect and drops calls of it.
  [[gnu::always_inline]] void operator()(uint32_t ref) const {
    constexpr uint64_t line_bytes = 64, lines = 5;  // of nodes, and of most leaves at any granule
    const std::byte* const child = block + node_ref::offset(ref);
    for (uint64_t line = 0; line < lines; ++line) __builtin_prefetch(child + line * line_bytes);
  }
};

}  // namespace rayloom::accel
