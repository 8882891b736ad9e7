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

  /// Member by member: a child put together elsewhere would be copied by loads that wait for all earlier stores.
  void push(const Box& box, uint32_t ref) {
    Child& next = child[count++];
    next.box = box;
    next.area = box.half_area();
    next.ref = ref;
  }
};

/// Sums over nodes and leaves.
struct WideSums {
  uint32_t granules = 0, node_count = 0, leaf_count = 0;
  double area = 0;

  void add(const WideSums& other);
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

  /// Adds `below` to `node`: its children if there is room for them, else as a node. Returns how many children that is.
  uint32_t join(const Box& box, const LooseWide& below, LooseWide& node, uint32_t room);

  /// The wide tree over the part of `tree` below `slot`, all but its root written. `leaf(slot, node, room)` adds a
  /// binary leaf to `node` as one child, or as several, up to `room`, if a wide tree ends there; it returns how many.
  /// No child that fits into its parent is left standing: node_bound() in sizes.h counts on that.
  template <class Leaf>
  LooseWide add_below(const BinaryTree& tree, const Collapse& collapse, uint32_t slot, const Leaf& leaf) {
    LooseWide node;
    if (tree[slot].is_leaf()) {
      leaf(slot, node, node_width);
      return node;
    }
    const ChildList list = collapse.planned(slot);
    uint32_t room = node_width - list.count;
    for (uint32_t i = 0; i < list.count; ++i) {
      const uint32_t child = list.slot[i];
      const BinaryNode& binary = tree[child];
      room += 1 - (binary.is_leaf() ? leaf(child, node, room + 1)
                                    : join(binary.box, add_below(tree, collapse, child, leaf), node, room + 1));
    }
    return node;
  }

  uint32_t granule() const { return granule_; }
  WideSums sums() const {
    return {granule_ - first_granule_, static_cast<uint32_t>(nodes_.size()), leaf_count_, area_};
  }
  /// Granules of the nodes, in the order they were written.
  const std::vector<uint32_t>& nodes() const { return nodes_; }

 private:
  std::byte* block_ = nullptr;
  uint32_t first_granule_ = 0, granule_ = 0, leaf_count_ = 0;
  double area_ = 0;  ///< summed over nodes and leaves
  std::vector<uint32_t> nodes_;
};

}  // namespace rayloom::accel
