#pragma once

#include <rayloom/accel/layout.h>

namespace rayloom::accel {

/// Asks for the lines of a child that will be visited: a test takes less time than a line takes to arrive. Lives
/// outside the traversal's target-specific code so that every target can inline it.
struct Prefetch {
  const std::byte* block;
  void operator()(uint32_t ref) const {
    constexpr uint64_t line_bytes = 64, node_lines = 4;  // at any granule
    const std::byte* const child = block + node_ref::offset(ref);
    for (uint64_t line = 0; line < node_lines; ++line) __builtin_prefetch(child + line * line_bytes);
    const std::byte* const rest = node_ref::is_leaf(ref) ? child + node_lines * line_bytes : child;
    for (uint64_t line = 0; line < 2; ++line) __builtin_prefetch(rest + line * line_bytes);
  }
};

}  // namespace rayloom::accel
