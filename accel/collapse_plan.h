#pragma once

#include <rayloom/accel/binary_tree.h>

#include <array>

namespace rayloom::accel {

inline constexpr uint32_t node_width = 8;

/// Of a binary subtree, by the slots j = 1..8 of a wide node that it may fill, at index j - 1. All 0 for a leaf, which
/// costs the same in every wide tree.
struct CollapsePlan {
  /// The least summed area of wide nodes, times the scale; 8 slots are a node's own and have none, but infinity.
  std::array<float, node_width> cost;
  /// How many of the j slots the left child gets; 0: as good with fewer.
  std::array<uint8_t, node_width> left_share;
};

}  // namespace rayloom::accel
