#include <rayloom/accel/curve_tree.h>
#include <rayloom/accel/sequence_split.h>

namespace rayloom::accel {
namespace {

class CurveTree {
 public:
  CurveTree(const CurveInput& input, BinaryTree& tree) : input_(input), tree_(tree) {}

  /// Returns the box of all, which read from the node just stored would have to wait for it.
  Box4 build(const Subtree& subtree) {
    const auto& [refs, keys, curve, leaf_size, binned_size, scratch, sorts] = input_;
    if (subtree.count <= binned_size) {
      build_binary_subtree(refs, scratch, leaf_size, subtree, tree_);
      return box4(tree_[subtree.slot].box);
    }
    if (subtree.count <= max_sweep) return build_sequence(refs, leaf_size, subtree, tree_, sorts);
    const auto code_of = [&](uint32_t i) { return input_.curve.code(input_.refs[subtree.first + i]); };
    const uint32_t cut = curve_cut(keys.subspan(subtree.first, subtree.count), subtree, leaf_size, code_of);
    const auto halves = halves_of(subtree, cut, leaf_size);
    Box4 box, other;
    build_halves(halves.first, halves.second,
                 [&](const Subtree& half) { (half.slot == halves.first.slot ? box : other) = build(half); });
    box.extend(other);
    store(box, subtree.first, subtree.count, halves.second.slot, tree_[subtree.slot]);
    return box;
  }

 private:
  const CurveInput& input_;
  BinaryTree& tree_;
};

}  // namespace

void build_on_curve(const CurveInput& input, const Subtree& root, BinaryTree& tree) {
  CurveTree(input, tree).build(root);
}

}  // namespace rayloom::accel
