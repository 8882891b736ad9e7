#pragma once

#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/subtree.h>

namespace rayloom::accel {

/// Builds `subtree` over its range of `refs`, whose order stays up to the sorting of each leaf by name: by surface area
/// cost where at most max_sweep are left, in halves of full leaves above and below max_choice_depth.
/// Without `sorts`, leaves keep their order, too. Returns the box of all.
Box4 build_sequence(std::span<PrimitiveRef> refs, uint32_t leaf_size, const Subtree& subtree, BinaryTree& tree,
                    bool sorts = true);

/// The cut that leaves full leaves on the left, about half of them.
uint32_t middle_cut(const Subtree& subtree, uint32_t leaf_size);

}  // namespace rayloom::accel
