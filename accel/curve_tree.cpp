#include <rayloom/accel/curve_tree.h>
#include <rayloom/accel/sequence_split.h>

namespace rayloom::accel {
namespace {

class CurveTree {
 public:
  CurveTree(const CurveInput& input, BinaryTree& tree) : input_(input), tree_(tree) {}

  void build(const Subtree& subtree) {
    const auto& [refs, keys, curve, leaf_size, binned_size, scratch, sorts] = input_;
    if (subtree.count <= binned_size) return build_binary_subtree(refs, scratch, leaf_size, subtree, tree_);
    if (subtree.count <= max_sweep) return build_sequence(refs, leaf_size, subtree, tree_, sorts);
    const auto code_of = [&](uint32_t i) { return input_.curve.code(input_.refs[subtree.first + i]); };
    const uint32_t cut = curve_cut(keys.subspan(subtree.first, subtree.count), subtree, leaf_size, code_of);
    const auto [left, right] = halves_of(subtree, cut, leaf_size);
    build_halves(left, right, [this](const Subtree& half) { build(half); });
    BinaryNode& node = tree_[subtree.slot];
    node = {tree_[left.slot].box, subtree.first, subtree.count, right.slot};
    node.box.extend(tree_[right.slot].box);
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
