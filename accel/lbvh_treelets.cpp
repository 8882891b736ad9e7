#include <rayloom/accel/lbvh.h>
#include <rayloom/accel/lbvh_treelets.h>
#include <rayloom/accel/loose_tree.h>
#include <rayloom/accel/sequence_tree.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

/// Smallest subtree that is rearranged, in full leaves. Measured: the smallest treelets, half of all, and further
/// rounds gain less than they cost.
constexpr uint32_t smallest_subtree = 14;

class Rearranged {
 public:
  Rearranged(const BuiltTree& start, uint32_t leaf_size, const Subtree& root)
      : start_(start), leaf_size_(leaf_size), nodes_(start.tree, leaf_size) {
    nodes_.restructure(smallest_subtree * leaf_size);
    built_.refs.resize(root.count);
    built_.tree.resize(2 * size_t{root.budget} - 1);
    emit(0, root);
  }

  BuiltTree take() { return std::move(built_); }

 private:
  /// Writes the subtree as its costs say, or its primitives in their order where budget or depth leave no choice.
  void emit(uint32_t slot, const Subtree& subtree) {
    const LooseNode& node = nodes_[slot];
    if (nodes_.is_final_leaf(node) || !fits(node, subtree)) {
      gather(slot, subtree.first);
      build_sequence(built_.refs, leaf_size_, subtree, built_.tree);
      return;
    }
    const auto [left, right] = halves_of(subtree, nodes_[node.left].count, leaf_size_);
    store(node.box, subtree.first, subtree.count, right.slot, built_.tree[subtree.slot]);
    build_halves(left, right, [&, this, first = left.first](const Subtree& half) {
      emit(half.first == first ? node.left : node.right, half);
    });
  }

  bool fits(const LooseNode& node, const Subtree& subtree) const {
    const uint32_t left = nodes_[node.left].count;
    return subtree.depth < max_choice_depth &&
           blocks_for(left, leaf_size_) + blocks_for(node.count - left, leaf_size_) <= subtree.budget;
  }

  /// Copies the primitives below a node, left to right; returns where the next ones go.
  uint32_t gather(uint32_t slot, uint32_t to) {
    const LooseNode& node = nodes_[slot];
    if (!node.is_leaf()) return gather(node.right, gather(node.left, to));
    std::copy_n(start_.refs.begin() + node.first, node.count, built_.refs.begin() + to);
    return to + node.count;
  }

  const BuiltTree& start_;
  uint32_t leaf_size_;
  LooseTree nodes_;
  BuiltTree built_;
};

}  // namespace

BuiltTree rearranged_by_treelets(const BuiltTree& start, uint32_t leaf_size, const Subtree& root) {
  return Rearranged(start, leaf_size, root).take();
}

BuiltTree build_lbvh_treelets(const PrimitiveRefs& refs, const TreeInput& input) {
  const Subtree root{0, 0, static_cast<uint32_t>(refs.size()), static_cast<uint32_t>(input.leaf_budget), 0};
  return rearranged_by_treelets(build_lbvh(refs, input), input.leaf_size, root);
}

}  // namespace rayloom::accel
