#pragma once

#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/collapse.h>
#include <rayloom/accel/layout.h>

namespace rayloom::accel {

/// A wide node with its place in the block and its children's.
struct WideNode {
  uint32_t ref;
  ChildList children;  ///< slots of the binary tree
  std::array<uint32_t, node_width> child_ref;
};

/// The wide tree laid out: a node's children lie together, inner nodes first, then leaves; nodes come depth first.
struct WideTree {
  ScratchVector<WideNode> nodes;  ///< depth first; the root first
  uint64_t bytes = 0;             ///< from the block's start to the end of the last leaf
  uint32_t depth = 0;             ///< nodes on the longest path
  uint64_t leaf_count = 0;
  double sah_cost = 0;
};

/// Bytes of each leaf, by slot of the binary tree, in granules.
using LeafBytes = std::vector<uint16_t>;

/// Places nodes and leaves from `first_byte` on. A tree of one leaf gets a node above it.
WideTree make_wide_tree(const BinaryTree& tree, uint64_t first_byte, const LeafBytes& leaf_bytes);

}  // namespace rayloom::accel
