#pragma once

// A binary tree that is being rearranged treelet by treelet.

#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/treelet.h>

namespace rayloom::accel {

class LooseTree {
 public:
  /// Nodes keep the slots of `tree`. Subtrees of at most `leaf_size` primitives may become one leaf; 0: none may.
  LooseTree(const BinaryTree& tree, uint32_t leaf_size);

  /// Rearranges, children first, the treelet below every node of at least `smallest` primitives.
  void restructure(uint32_t smallest) { restructure_below(0, smallest); }

  const LooseNode& operator[](uint32_t slot) const { return nodes_[slot]; }
  /// Whether the node costs least as one leaf.
  bool is_final_leaf(const LooseNode& node) const {
    return node.is_leaf() || better_as_leaf(node.area, node.count, split_cost(node), leaf_size_);
  }

 private:
  void loosen(const BinaryTree& tree, size_t begin, size_t end);
  void evaluate(uint32_t slot);
  void restructure_below(uint32_t slot, uint32_t smallest);
  template <class Visit>
  void visit_children(const LooseNode& node, const Visit& visit);
  float split_cost(const LooseNode& node) const {
    return node.area * inner_cost + nodes_[node.left].cost + nodes_[node.right].cost;
  }

  uint32_t leaf_size_;
  BoxArea area_;
  ScratchVector<LooseNode> nodes_;
};

}  // namespace rayloom::accel
