#pragma once

// The FLIP error map of two pictures that a screen shows (LDR-FLIP: Andersson et al., "FLIP: A Difference Evaluator for
// Alternating Images", HPG 2020, sections 4.1 to 4.3).

#include <rayloom/tools/flip_plane.h>

namespace rayloom::tools::flip {

/// How different each pixel looks when the two pictures alternate on a screen: 0 the same, 1 as different as colours
/// get. Takes linear RGB in [0,1], of one size and at least one pixel; the order of the pictures does not matter.
Plane error_map(const Planes& picture, const Planes& reference, double pixels_per_degree);

}  // namespace rayloom::tools::flip
