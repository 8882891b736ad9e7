#pragma once

#include <rayloom/accel/tree_builder.h>

namespace rayloom::accel {

/// Linear bounding volume hierarchy: references sorted along a Morton curve and split where the codes' highest bit
/// changes (Lauterbach et al. 2009); the last levels are cut by surface area without leaving the order, which fills
/// leaves as well as binning does.
BuiltTree build_lbvh(const PrimitiveRefs& refs, const TreeInput& input);

}  // namespace rayloom::accel
