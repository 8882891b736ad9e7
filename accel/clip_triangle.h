#pragma once

// Cutting a triangle's box in two at a plane, for spatial splits.

#include <rayloom/accel/box.h>
#include <rayloom/accel/triangle_input.h>

namespace rayloom::accel {

/// Boxes of the two parts; empty where a part is.
struct Halves {
  Box left, right;
};

/// Boxes of what lies of `triangle` inside `cell` below and above `plane` (a coordinate on `axis`), rounded outward:
/// every point of the triangle, as real numbers, that is in `cell` is in one of them. This is what keeps hits exact:
/// the point of an exact hit lies in the box of at least one reference, so the ray enters it and all boxes above it
/// (docs/numerics.md 3.1).
Halves clip_triangle(const InputTriangle& triangle, const Box& cell, int axis, float plane);

}  // namespace rayloom::accel
