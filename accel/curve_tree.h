#pragma once

// Trees over primitives in the order of a Morton curve (Lauterbach et al. 2009).

#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/morton.h>
#include <rayloom/accel/sequence_tree.h>

#include <algorithm>
#include <bit>

namespace rayloom::accel {

namespace detail {

/// So many codes are in the cache when they are searched.
inline constexpr uint32_t cached = 4096;

/// How many of `count` ascending codes have a 0 in the highest bit in which they differ; 0: all are equal. ask(i) says
/// that code_of(i) may come next.
template <class CodeOf, class Ask>
uint32_t change_of(uint32_t count, const CodeOf& code_of, const Ask& ask) {
  const uint32_t far = count > cached ? 32 : count;
  const auto bit = std::bit_floor(code_of(0) ^ code_of(count - 1));
  if (bit == 0) return 0;
  uint32_t first = 0;  // a 0; without branches, which nobody could predict
  for (uint32_t left = count; left > 1;) {
    const uint32_t half = left / 2;
    if (left > far) ask(first + half / 2), ask(first + half + half / 2);
    first += (code_of(first + half) & bit) == 0 ? half : 0;
    left -= half;
  }
  return first + 1;
}

inline uint32_t change_of(std::span<const MortonKey> keys) {
  const auto ask = [&](uint32_t i) { __builtin_prefetch(&keys[i]); };
  return change_of(
      static_cast<uint32_t>(keys.size()), [&](uint32_t i) { return keys[i].code; }, ask);
}

/// `cut`, or the multiple of the leaf size next to it when the budget has no block to spare.
inline uint32_t fitting(const Subtree& subtree, uint32_t cut, uint32_t leaf_size) {
  if (blocks_for(cut, leaf_size) + blocks_for(subtree.count - cut, leaf_size) <= subtree.budget) return cut;
  const uint32_t below = cut / leaf_size * leaf_size, above = below + leaf_size;
  return below == 0 || (above < subtree.count && above - cut < cut - below) ? above : below;
}

}  // namespace detail

/// How many primitives go left: those before the codes' highest change, as budget and depth allow. `keys` are the
/// subtree's; code_of(i) gives all 63 bits of the i-th where the keys' do not tell.
template <class CodeOf>
uint32_t curve_cut(std::span<const MortonKey> keys, const Subtree& subtree, uint32_t leaf_size, const CodeOf& code_of) {
  if (subtree.depth >= max_choice_depth) return middle_cut(subtree, leaf_size);
  uint32_t cut = detail::change_of(keys);
  if (cut == 0) cut = detail::change_of(subtree.count, code_of, [](uint32_t) {});
  return cut == 0 ? middle_cut(subtree, leaf_size) : detail::fitting(subtree, cut, leaf_size);
}

/// Primitives in the order of their keys.
struct CurveInput {
  std::span<PrimitiveRef> refs;
  std::span<const MortonKey> keys;
  const MortonCurve& curve;
  uint32_t leaf_size;
  /// Subtrees of at most so many primitives are split by binned SAH; `scratch`, as long as refs, is for them.
  uint32_t binned_size = 0;
  std::span<PrimitiveRef> scratch{};
  bool sorts_leaves = true;  ///< by name, where not binned
};

/// Builds `root`: splits where the codes' highest bit changes. Where not binned, the last levels are cut by surface
/// area without leaving the order, which fills leaves nearly as well.
void build_on_curve(const CurveInput& input, const Subtree& root, BinaryTree& tree);

}  // namespace rayloom::accel
