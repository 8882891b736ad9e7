#include <rayloom/accel/binned_sah.h>
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
      : unsorted_(refs),
        curve_(bounds_of(refs).centres),
        keys_(sorted_keys(curve_, refs)),
        leaf_size_(input.leaf_size) {
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
    uint32_t cut = change_of(keys, [](const MortonKey& key) { return key.code; });
    if (cut == 0) cut = change_of(keys, [this](const MortonKey& key) { return curve_.code(unsorted_[key.index]); });
    if (cut == 0) return middle_cut(subtree, leaf_size_);
    return fitting(subtree, cut);
  }

  /// How many keys have a 0 in the highest bit in which codes differ; 0: all are equal.
  template <class CodeOf>
  static uint32_t change_of(std::span<const MortonKey> keys, const CodeOf& code_of) {
    const auto change = code_of(keys.front()) ^ code_of(keys.back());
    const auto bit = std::bit_floor(change);
    if (bit == 0) return 0;
    const auto cut =
        std::partition_point(keys.begin(), keys.end(), [&](const MortonKey& key) { return (code_of(key) & bit) == 0; });
    return static_cast<uint32_t>(cut - keys.begin());
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
  MortonCurve curve_;
  ScratchVector<MortonKey> keys_;
  uint32_t leaf_size_;
  BuiltTree built_;
};

}  // namespace

BuiltTree build_lbvh(const PrimitiveRefs& refs, const TreeInput& input) { return LbvhBuilder(refs, input).take(); }

}  // namespace rayloom::accel
