#pragma once

// Boxes of a finished structure computed anew from its leaves upward, the tree as it is: what an update does (UP rows).

#include <rayloom/accel/box.h>
#include <rayloom/accel/layout.h>
#include <rayloom/base/parallel.h>

#include <algorithm>

namespace rayloom::accel {

/// What a subtree comes to.
struct Refitted {
  Box box;                  ///< for the parent's planes
  Box bounds;               ///< the same without boxes opened for ill-conditioned instances
  double area_sum = 0;      ///< of nodes and leaves
  double conditioning = 0;  ///< largest of the instances whose boxes are not opened

  void merge(const Refitted& other) {
    box.extend(other.box);
    bounds.extend(other.bounds);
    area_sum += other.area_sum;
    conditioning = std::max(conditioning, other.conditioning);
  }
};

/// refit_leaf(address), a Refitted, rewrites one leaf. In parallel; sums are taken in the order of the children.
template <class RefitLeaf>
class TreeRefit {
 public:
  TreeRefit(std::byte* block, const RefitLeaf& refit_leaf) : block_(block), refit_leaf_(refit_leaf) {}

  Refitted node(uint32_t ref, uint32_t depth = 0) const {
    auto& node = *reinterpret_cast<Node8*>(block_ + node_ref::offset(ref));
    Refitted children[8];
    if (depth < parallel_depth) {
      parallel_for(8, 1, [&](uint64_t i, uint64_t) { children[i] = child(node.child[i], depth); });
    } else {
      for (int i = 0; i < 8; ++i) children[i] = child(node.child[i], depth);
    }
    Refitted sum;
    for (int i = 0; i < 8; ++i) {
      write_box(children[i].box, i, node);
      sum.merge(children[i]);
    }
    sum.area_sum += sum.bounds.half_area();
    return sum;
  }

 private:
  static constexpr uint32_t parallel_depth = 3;  ///< up to 512 pieces

  /// Granule 0 is the header: the mark of an empty slot. A leaf in which nothing is active gets an empty box as well.
  Refitted child(uint32_t ref, uint32_t depth) const {
    if (ref == 0) return {};
    if (!node_ref::is_leaf(ref)) return node(ref, depth + 1);
    Refitted leaf = refit_leaf_(block_ + node_ref::offset(ref));
    leaf.area_sum = leaf.bounds.half_area();
    return leaf;
  }

  /// Adding 0 turns -0 into +0.
  static void write_box(const Box& box, int lane, Node8& node) {
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[axis][0][lane] = box.min[axis] + 0.0f;
      node.bounds[axis][1][lane] = box.max[axis] + 0.0f;
    }
  }

  std::byte* block_;
  const RefitLeaf& refit_leaf_;
};

}  // namespace rayloom::accel
