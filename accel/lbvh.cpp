#include <rayloom/accel/lbvh.h>
#include <rayloom/accel/morton.h>
#include <rayloom/accel/sequence_split.h>
#include <rayloom/accel/sequence_tree.h>
#include <rayloom/accel/subtree.h>

#include <algorithm>
#include <bit>

namespace rayloom::accel {
namespace {

class LbvhBuilder {
 public:
  LbvhBuilder(const PrimitiveRefs& refs, const TreeInput& input)
      : unsorted_(refs), keys_(morton_keys(refs)), leaf_size_(input.leaf_size) {
    sort_keys(keys_, refs);
    built_.refs.resize(refs.size());
    built_.tree.resize(2 * input.leaf_budget - 1);
    build({0, 0, static_cast<uint32_t>(refs.size()), static_cast<uint32_t>(input.leaf_budget), 0});
  }

  BuiltTree take() { return std::move(built_); }

 private:
  void build(const Subtree& subtree) {
    if (subtree.count <= max_sweep) {
      gather(subtree);
      return build_sequence(built_.refs, leaf_size_, subtree, built_.tree);
    }
    const auto [left, right] = halves_of(subtree, curve_cut(subtree), leaf_size_);
    build_halves(left, right, [this](const Subtree& half) { build(half); });
    join(subtree, left, right);
  }

  /// How many keys of the range go left.
  uint32_t curve_cut(const Subtree& subtree) const {
    if (subtree.depth >= max_choice_depth) return middle_cut(subtree, leaf_size_);
    const auto keys = std::span(keys_).subspan(subtree.first, subtree.count);
    const uint64_t change = keys.front().code ^ keys.back().code;
    if (change == 0) return middle_cut(subtree, leaf_size_);
    const uint64_t bit = std::bit_floor(change);
    const auto cut =
        std::partition_point(keys.begin(), keys.end(), [bit](const MortonKey& key) { return (key.code & bit) == 0; });
    return fitting(subtree, static_cast<uint32_t>(cut - keys.begin()));
  }

  /// `cut`, or the multiple of the leaf size next to it when the budget has no block to spare.
  uint32_t fitting(const Subtree& subtree, uint32_t cut) const {
    if (blocks_for(cut, leaf_size_) + blocks_for(subtree.count - cut, leaf_size_) <= subtree.budget) return cut;
    const uint32_t below = cut / leaf_size_ * leaf_size_, above = below + leaf_size_;
    return below == 0 || (above < subtree.count && above - cut < cut - below) ? above : below;
  }

  void gather(const Subtree& subtree) {
    for (uint32_t i = subtree.first; i < subtree.first + subtree.count; ++i) built_.refs[i] = unsorted_[keys_[i].index];
  }

  void join(const Subtree& subtree, const Subtree& left, const Subtree& right) {
    BinaryNode& node = built_.tree[subtree.slot];
    node = {built_.tree[left.slot].box, subtree.first, subtree.count, right.slot};
    node.box.extend(built_.tree[right.slot].box);
  }

  const PrimitiveRefs& unsorted_;
  ScratchVector<MortonKey> keys_;
  uint32_t leaf_size_;
  BuiltTree built_;
};

}  // namespace

BuiltTree build_lbvh(const PrimitiveRefs& refs, const TreeInput& input) { return LbvhBuilder(refs, input).take(); }

}  // namespace rayloom::accel
