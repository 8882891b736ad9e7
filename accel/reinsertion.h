#pragma once

#include <rayloom/accel/binary_tree.h>

namespace rayloom::accel {

/// How much work goes into it.
struct ReinsertionEffort {
  uint32_t rounds = 3;
  uint32_t share = 16;  ///< each round tries the largest nodes, one in so many
};

/// Improves a tree of at least one node by moving subtrees to where they enlarge the boxes least: Meister and Bittner,
/// "Parallel Reinsertion for Bounding Volume Hierarchy Optimization" (2018). Each round looks for the best place of
/// many subtrees in the same tree, in parallel; then moves are made by falling gain, each unless an earlier one touched
/// its nodes: the result does not depend on the number of threads. Leaves stay as they are, so this is right for split
/// triangles too. Gives back a tree no deeper than max_depth, if need be the tree it was given. Ranges of inner nodes
/// are no longer contiguous: their `first` and `count` name the first range below and the sum.
BinaryTree reinsert(BinaryTree tree, const ReinsertionEffort& effort);

}  // namespace rayloom::accel
