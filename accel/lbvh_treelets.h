#pragma once

#include <rayloom/accel/subtree.h>
#include <rayloom/accel/tree_builder.h>

namespace rayloom::accel {

/// `start` rearranged by treelets for the least cost; leaves that fit one of `leaf_size` together may be joined. `root`
/// gives budget, count and depth; both trees start at slot and reference 0.
BuiltTree rearranged_by_treelets(const BuiltTree& start, uint32_t leaf_size, const Subtree& root);

/// A linear hierarchy rearranged by treelets.
BuiltTree build_lbvh_treelets(const PrimitiveRefs& refs, const TreeInput& input);

}  // namespace rayloom::accel
