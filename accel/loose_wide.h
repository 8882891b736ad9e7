#pragma once

// Wide nodes written bottom-up, while it is open whether a node is written or its children go into its parent.

#include <rayloom/accel/collapse.h>
#include <rayloom/accel/layout.h>

#include <cstddef>
#include <vector>

namespace rayloom::accel {

/// A wide node that has no place yet; what its children refer to has.
struct LooseWide {
  struct Child {
    Box box;
    double area;  ///< half of the box's surface
    uint32_t ref;
  };
  uint32_t count = 0;
  uint32_t depth = 0;  ///< nodes on the longest path below
  std::array<Child, node_width> child;

  void push(const Box& box, uint32_t ref) { child[count++] = {box, box.half_area(), ref}; }
};

/// Bytes of nodes and leaves one after another, and sums over them.
class WideBytes {
 public:
  /// Writes from `granule` of `block` on.
  void start(std::byte* block, uint32_t granule);

  /// Where the next leaf goes.
  std::byte* next() const { return block_ + uint64_t{granule_} * granule_bytes; }
  /// Takes the bytes written at next() for a leaf and returns its reference.
  uint32_t add_leaf(uint64_t bytes);
  /// Writes a node: inner children first, then leaves, by rising area; any-hit rays visit them from the last to the
  /// first. Returns its reference.
  uint32_t add_node(const LooseWide& node);

  /// The wide tree over the part of `tree` below `slot`, all but its root written. `leaf(slot)` gives a binary leaf as
  /// a LooseWide of one child, or of several if a wide tree ends there. No child that fits into its parent is left
  /// standing: node_bound() in sizes.h counts on that.
  template <class Leaf>
  LooseWide add_below(const BinaryTree& tree, const Collapse& collapse, uint32_t slot, const Leaf& leaf) {
    if (tree[slot].is_leaf()) return leaf(slot);
    const ChildList list = collapse.planned(slot);
    LooseWide node;
    uint32_t count = list.count;
    for (uint32_t i = 0; i < list.count; ++i) {
      const LooseWide below = add_below(tree, collapse, list.slot[i], leaf);
      if (count - 1 + below.count <= node_width) {
        count += below.count - 1;
        absorb(below, node);
      } else {
        node.depth = std::max(node.depth, below.depth + 1);
        node.push(tree[list.slot[i]].box, add_node(below));
      }
    }
    return node;
  }

  uint32_t granule() const { return granule_; }
  uint32_t leaf_count() const { return leaf_count_; }
  double area() const { return area_; }
  /// Granules of the nodes, in the order they were written.
  const std::vector<uint32_t>& nodes() const { return nodes_; }

 private:
  static void absorb(const LooseWide& from, LooseWide& into);

  std::byte* block_ = nullptr;
  uint32_t granule_ = 0, leaf_count_ = 0;
  double area_ = 0;  ///< summed over nodes and leaves
  std::vector<uint32_t> nodes_;
};

}  // namespace rayloom::accel
