#pragma once

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/primitive_ref.h>

#include <optional>
#include <vector>

namespace rayloom::accel {

/// Box `index` of a geometry as traversal tests it: inverted boxes (minimum above maximum on some axis) become the
/// point at their centre (PR-12), infinities the largest float. Empty for an inactive box: NaN in MinX (PR-02) or, by
/// our policy for PR-07, in any bound.
std::optional<Box> read_box(const AabbGeometry& geometry, uint32_t index);

/// References to the active boxes.
PrimitiveRefs procedural_refs(std::span<const AabbGeometry> geometries);

}  // namespace rayloom::accel
