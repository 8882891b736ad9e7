#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/partition.h>
#include <rayloom/accel/subtree.h>

#include <algorithm>
#include <cassert>

namespace rayloom::accel {
namespace {

class BinaryBuilder {
 public:
  /// Halves of `large` primitives together are built at the same time.
  BinaryBuilder(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, uint32_t leaf_size, BinaryTree& tree,
                uint32_t large)
      : refs_(refs), scratch_(scratch), leaf_size_(leaf_size), tree_(tree), large_(large) {}

  void build(const Subtree& subtree) {
    const auto refs = refs_.subspan(subtree.first, subtree.count);
    const RangeBounds bounds = bounds_of(refs);
    BinaryNode& node = tree_[subtree.slot];
    node = {bounds.box, subtree.first, subtree.count, 0};
    if (subtree.count <= leaf_size_) return std::sort(refs.begin(), refs.end(), name_less);
    const auto left_count = static_cast<uint32_t>(partition(subtree, bounds.centres));
    const auto [left, right] = halves_of(subtree, left_count, leaf_size_);
    node.right = right.slot;
    build_halves(
        left, right, [this](const Subtree& half) { build(half); }, large_);
  }

 private:
  size_t partition(const Subtree& subtree, const Box& centres) {
    const auto refs = refs_.subspan(subtree.first, subtree.count);
    if (subtree.depth < max_choice_depth)
      if (const auto split = find_binned_split(refs, centres, leaf_size_, subtree.budget))
        return partition_by_split(refs, scratch_.subspan(subtree.first, subtree.count), *split);
    return partition_by_median(refs, centres, leaf_size_);
  }

  std::span<PrimitiveRef> refs_;
  std::span<PrimitiveRef> scratch_;
  uint32_t leaf_size_;
  BinaryTree& tree_;
  uint32_t large_;
};

}  // namespace

void build_binary_subtree(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, uint32_t leaf_size,
                          const Subtree& subtree, BinaryTree& tree) {
  BinaryBuilder(refs, scratch, leaf_size, tree, 4096).build(subtree);
}

BinaryTree build_binary_tree(std::span<PrimitiveRef> refs, const BinaryBuildOptions& options) {
  assert(options.leaf_budget >= blocks_for(refs.size(), options.leaf_size));
  PrimitiveRefs scratch(refs.size());
  BinaryTree tree(2 * options.leaf_budget - 1);
  const auto count = static_cast<uint32_t>(refs.size());
  BinaryBuilder(refs, scratch, options.leaf_size, tree, 512)
      .build({0, 0, count, static_cast<uint32_t>(options.leaf_budget), 0});
  return tree;
}

}  // namespace rayloom::accel
