#include <rayloom/accel/wide_tree.h>

#include <algorithm>
#include <cassert>

namespace rayloom::accel {
namespace {

class Layout {
 public:
  Layout(const BinaryTree& tree, uint64_t first_byte, const LeafBytes& leaf_bytes)
      : tree_(tree), collapse_(tree), leaf_bytes_(leaf_bytes) {
    wide_.bytes = first_byte;
    add(0, take(sizeof(Node8)), 1);
    const double root_area = tree[0].box.half_area();
    wide_.sah_cost = root_area > 0 ? area_sum_ / root_area : static_cast<double>(wide_.nodes.size() + wide_.leaf_count);
  }

  WideTree finish() { return std::move(wide_); }

 private:
  uint32_t take(uint64_t bytes) {
    const uint64_t granule = wide_.bytes / granule_bytes;
    wide_.bytes += bytes;
    return static_cast<uint32_t>(granule);
  }

  ChildList children_of(uint32_t slot) const {
    if (!tree_[slot].is_leaf()) return collapse_.children(slot);
    ChildList only;  // the root of a tree of one leaf
    only.push(slot);
    return only;
  }

  void add(uint32_t slot, uint32_t ref, uint32_t depth) {
    WideNode node{ref, children_of(slot), {}};
    const ChildList& list = node.children;
    for (uint32_t i = 0; i < list.count; ++i)
      if (!tree_[list.slot[i]].is_leaf()) node.child_ref[i] = take(sizeof(Node8));
    for (uint32_t i = 0; i < list.count; ++i)
      if (tree_[list.slot[i]].is_leaf()) node.child_ref[i] = add_leaf(list.slot[i]);
    area_sum_ += tree_[slot].box.half_area();
    wide_.depth = std::max(wide_.depth, depth);
    wide_.nodes.push_back(node);
    for (uint32_t i = 0; i < list.count; ++i)
      if (!node_ref::is_leaf(node.child_ref[i])) add(list.slot[i], node.child_ref[i], depth + 1);
  }

  uint32_t add_leaf(uint32_t slot) {
    area_sum_ += tree_[slot].box.half_area();
    ++wide_.leaf_count;
    return take(uint64_t{leaf_bytes_[slot]} * granule_bytes) | node_ref::leaf_bit;
  }

  const BinaryTree& tree_;
  Collapse collapse_;
  const LeafBytes& leaf_bytes_;
  double area_sum_ = 0;
  WideTree wide_;
};

}  // namespace

WideTree make_wide_tree(const BinaryTree& tree, uint64_t first_byte, const LeafBytes& leaf_bytes) {
  assert(first_byte % granule_bytes == 0);
  return Layout(tree, first_byte, leaf_bytes).finish();
}

}  // namespace rayloom::accel
