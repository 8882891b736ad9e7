#pragma once

#include <rayloom/accel/tree_builder.h>

namespace rayloom::accel {

/// Binned SAH with spatial splits where the two sides of the best object split overlap, then reinsertion. References
/// come to more than were given; at most split_reference_bound() and so that leaf_budget suffices. A range never holds
/// two references of one primitive, since a split sends them to different sides.
BuiltTree build_split_tree(PrimitiveRefs refs, const TreeInput& input);

}  // namespace rayloom::accel
