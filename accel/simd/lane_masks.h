#pragma once

#include <cstdint>

namespace rayloom::accel {

/// What a leaf's filter found, one bit a lane, unused lanes clear in both. A lane outside `possible` is certainly
/// missed by the ray's line. A lane in `certain` is certainly hit by it: call finish_triangle(). The other possible
/// lanes are undecided: call intersect_triangle(). Neither mask says anything of t.
struct LeafMasks {
  uint32_t possible = 0;
  uint32_t certain = 0;
};

}  // namespace rayloom::accel
