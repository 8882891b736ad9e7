#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/partition.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <cassert>
#include <memory>

namespace rayloom::accel {
namespace {

/// Below this depth cost no longer chooses: halving 2^29 primitives down to one leaf takes at most 29 further levels.
constexpr uint32_t max_sah_depth = 32;
constexpr size_t parallel_threshold = 4096;

/// A subtree to build: it owns the slots [slot, slot + 2 * budget - 1) and the primitives [first, first + count).
struct Subtree {
  uint32_t slot, first, count, budget, depth;
};

class BinaryBuilder {
 public:
  BinaryBuilder(std::span<PrimitiveRef> refs, const BinaryBuildOptions& options)
      : refs_(refs),
        scratch_(std::make_unique_for_overwrite<PrimitiveRef[]>(refs.size())),
        leaf_size_(options.leaf_size),
        tree_(2 * options.leaf_budget - 1) {
    assert(options.leaf_budget >= blocks_for(refs.size(), leaf_size_));
    const auto count = static_cast<uint32_t>(refs.size());
    build({0, 0, count, static_cast<uint32_t>(options.leaf_budget), 0});
  }

  BinaryTree take() { return std::move(tree_); }

 private:
  void build(const Subtree& subtree) {
    const auto refs = refs_.subspan(subtree.first, subtree.count);
    const RangeBounds bounds = bounds_of(refs);
    BinaryNode& node = tree_[subtree.slot];
    node = {bounds.box, subtree.first, subtree.count, 0};
    if (subtree.count <= leaf_size_) return std::sort(refs.begin(), refs.end(), name_less);
    const auto left_count = static_cast<uint32_t>(partition(subtree, bounds.centres));
    const auto [left, right] = children(subtree, left_count);
    node.right = right.slot;
    build_both(left, right);
  }

  size_t partition(const Subtree& subtree, const Box& centres) {
    const auto refs = refs_.subspan(subtree.first, subtree.count);
    if (subtree.depth < max_sah_depth)
      if (const auto split = find_binned_split(refs, centres, leaf_size_, subtree.budget))
        return partition_by_split(refs, {scratch_.get() + subtree.first, subtree.count}, *split);
    return partition_by_median(refs, centres, leaf_size_);
  }

  /// Shares out the blocks that the budget has beyond need in proportion to need.
  std::pair<Subtree, Subtree> children(const Subtree& parent, uint32_t left_count) const {
    const uint32_t right_count = parent.count - left_count;
    const uint64_t left_need = blocks_for(left_count, leaf_size_), right_need = blocks_for(right_count, leaf_size_);
    const uint64_t slack = parent.budget - left_need - right_need;
    const auto left_budget = static_cast<uint32_t>(left_need + slack * left_need / (left_need + right_need));
    const uint32_t depth = parent.depth + 1;
    return {
        {parent.slot + 1, parent.first, left_count, left_budget, depth},
        {parent.slot + 2 * left_budget, parent.first + left_count, right_count, parent.budget - left_budget, depth}};
  }

  void build_both(const Subtree& left, const Subtree& right) {
    if (left.count + right.count < parallel_threshold) {
      build(left);
      build(right);
      return;
    }
    parallel_invoke([this, left] { build(left); }, [this, right] { build(right); });
  }

  std::span<PrimitiveRef> refs_;
  std::unique_ptr<PrimitiveRef[]> scratch_;
  uint32_t leaf_size_;
  BinaryTree tree_;
};

}  // namespace

BinaryTree build_binary_tree(std::span<PrimitiveRef> refs, const BinaryBuildOptions& options) {
  return BinaryBuilder(refs, options).take();
}

}  // namespace rayloom::accel
