#pragma once

#include <cstdint>

namespace rayloom::accel {

/// What a leaf's filter found, one bit a lane, unused lanes clear in all. A lane outside `possible` is certainly missed
/// by the ray's line, or met outside the interval. A lane in `certain` is certainly hit by the line: call
/// finish_triangle(). The other possible lanes are undecided: call intersect_triangle(). A certain lane in `inside` is
/// certainly hit inside the interval.
struct LeafMasks {
  uint32_t possible = 0;
  uint32_t certain = 0;
  uint32_t inside = 0;
};

}  // namespace rayloom::accel
