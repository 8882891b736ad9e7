#include <rayloom/accel/sequence_split.h>
#include <rayloom/accel/sequence_tree.h>

#include <algorithm>
#include <array>
#include <limits>

namespace rayloom::accel {
namespace {

Box4 box_of(std::span<const PrimitiveRef> refs) {
  Box4 box;
  for (const PrimitiveRef& ref : refs) box.extend(box4(ref));
  return box;
}

using Word4 __attribute__((vector_size(16))) = int32_t;

/// By counting for each primitive of one geometry how many come before it, without branches nobody can predict.
void sort_by_primitive(std::span<PrimitiveRef> leaf) {
  constexpr size_t most = 8;
  std::array<PrimitiveRef, most> from;
  int32_t name[most];
  std::fill_n(name, most, std::numeric_limits<int32_t>::max());
  for (size_t i = 0; i < leaf.size(); ++i) {
    from[i] = leaf[i];
    name[i] = static_cast<int32_t>(leaf[i].primitive);
  }
  Word4 low, high, before_low = {}, before_high = {};
  std::memcpy(&low, name, sizeof(low));
  std::memcpy(&high, name + 4, sizeof(high));
  for (size_t i = 0; i < leaf.size(); ++i) {
    const Word4 one = Word4{} + name[i];
    before_low -= one < low;
    before_high -= one < high;
  }
  for (size_t i = 0; i < leaf.size(); ++i)
    leaf[static_cast<size_t>(i < 4 ? before_low[i] : before_high[i - 4])] = from[i];
}

/// By name.
void sort_leaf(std::span<PrimitiveRef> leaf) {
  const auto same_geometry = [&](const PrimitiveRef& ref) { return ref.geometry == leaf[0].geometry; };
  if (leaf.size() <= 8 && std::all_of(leaf.begin(), leaf.end(), same_geometry)) return sort_by_primitive(leaf);
  std::sort(leaf.begin(), leaf.end(), name_less);
}

class SequenceBuilder {
 public:
  SequenceBuilder(std::span<PrimitiveRef> refs, uint32_t leaf_size, BinaryTree& tree, bool sorts)
      : refs_(refs), leaf_size_(leaf_size), tree_(tree), sorts_(sorts) {}

  Box4 build(const Subtree& subtree) {
    const auto range = range_of(subtree);
    if (subtree.count <= leaf_size_) return build_leaf(subtree, box_of(range));
    const bool choice = subtree.count <= max_sweep && subtree.depth < max_choice_depth;
    const SequenceCut cut = choice ? cheapest_cut(range, leaf_size_) : middle(subtree);
    const auto [left, right] = halves_of(subtree, static_cast<uint32_t>(cut.left_count), leaf_size_);
    Box4 box = build_half(left, cut.left);
    box.extend(build_half(right, cut.right));
    store(box, subtree.first, subtree.count, right.slot, tree_[subtree.slot]);
    return box;
  }

 private:
  std::span<PrimitiveRef> range_of(const Subtree& subtree) const { return refs_.subspan(subtree.first, subtree.count); }

  Box4 build_half(const Subtree& half, const Box4& box) {
    return half.count <= leaf_size_ ? build_leaf(half, box) : build(half);
  }

  Box4 build_leaf(const Subtree& leaf, const Box4& box) {
    store(box, leaf.first, leaf.count, 0, tree_[leaf.slot]);
    if (sorts_) sort_leaf(range_of(leaf));
    return box;
  }

  SequenceCut middle(const Subtree& subtree) const {
    const auto range = range_of(subtree);
    const uint32_t count = middle_cut(subtree, leaf_size_);
    return {count, box_of(range.first(count)), box_of(range.subspan(count))};
  }

  std::span<PrimitiveRef> refs_;
  uint32_t leaf_size_;
  BinaryTree& tree_;
  bool sorts_;
};

}  // namespace

uint32_t middle_cut(const Subtree& subtree, uint32_t leaf_size) {
  return static_cast<uint32_t>(blocks_for(subtree.count, leaf_size) / 2 * leaf_size);
}

Box4 build_sequence(std::span<PrimitiveRef> refs, uint32_t leaf_size, const Subtree& subtree, BinaryTree& tree,
                    bool sorts) {
  return SequenceBuilder(refs, leaf_size, tree, sorts).build(subtree);
}

}  // namespace rayloom::accel
