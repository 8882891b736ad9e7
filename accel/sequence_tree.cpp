#include <rayloom/accel/float4.h>
#include <rayloom/accel/sequence_split.h>
#include <rayloom/accel/sequence_tree.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

uint32_t cut_of(std::span<const PrimitiveRef> range, const Box& box, uint32_t leaf_size, const Subtree& subtree) {
  if (subtree.count > max_sweep || subtree.depth >= max_choice_depth) return middle_cut(subtree, leaf_size);
  return static_cast<uint32_t>(cheapest_cut(range, box, leaf_size, subtree.budget));
}

}  // namespace

uint32_t middle_cut(const Subtree& subtree, uint32_t leaf_size) {
  return static_cast<uint32_t>(blocks_for(subtree.count, leaf_size) / 2 * leaf_size);
}

void build_sequence(std::span<PrimitiveRef> refs, uint32_t leaf_size, const Subtree& subtree, BinaryTree& tree) {
  const auto range = refs.subspan(subtree.first, subtree.count);
  Box4 bounds;
  for (const PrimitiveRef& ref : range) bounds.extend(box4(ref));
  const Box box = bounds.box();
  tree[subtree.slot] = {box, subtree.first, subtree.count, 0};
  if (subtree.count <= leaf_size) return std::sort(range.begin(), range.end(), name_less);
  const auto [left, right] = halves_of(subtree, cut_of(range, box, leaf_size, subtree), leaf_size);
  tree[subtree.slot].right = right.slot;
  build_sequence(refs, leaf_size, left, tree);
  build_sequence(refs, leaf_size, right, tree);
}

}  // namespace rayloom::accel
