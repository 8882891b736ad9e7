// How the children that a ray meets go on the stack, in vectors of eight; see children_scalar.h. Re-included once per
// target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_CHILDREN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_CHILDREN_INL_H_
#undef RAYLOOM_ACCEL_CHILDREN_INL_H_
#else
#define RAYLOOM_ACCEL_CHILDREN_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/compress_table.h>
#include <rayloom/accel/simd/lanes-inl.h>
#include <rayloom/accel/traversal_stack.h>

#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

using Keys = hn::FixedTag<int32_t, 8>;
using FewKeys = hn::FixedTag<int32_t, 4>;

/// One column of a sorting network: every lane meets lane `with[lane]`; lanes of `smaller` keep the smaller key.
template <class D, class V>
HWY_INLINE V exchange(D d, V keys, const int32_t* with, const int32_t* smaller) {
  const V other = hn::TableLookupLanes(keys, hn::SetTableIndices(d, with));
  const auto take_smaller = hn::Lt(hn::Load(d, smaller), hn::Zero(d));
  return hn::IfThenElse(take_smaller, hn::Min(keys, other), hn::Max(keys, other));
}

/// Descending, three columns.
HWY_INLINE hn::Vec<FewKeys> sort_few(hn::Vec<FewKeys> keys) {
  const FewKeys d;
  const auto pairs = hn::Shuffle2301(keys);
  keys = hn::OddEven(hn::Min(keys, pairs), hn::Max(keys, pairs));
  const auto halves = hn::Shuffle1032(keys);
  keys = hn::ConcatUpperLower(d, hn::Min(keys, halves), hn::Max(keys, halves));
  alignas(16) static constexpr int32_t with[] = {0, 2, 1, 3}, smaller[] = {0, 0, -1, 0};
  return exchange(d, keys, with, smaller);
}

/// Descending, the network of 19 comparators in six columns.
HWY_INLINE hn::Vec<Keys> sort_many(hn::Vec<Keys> keys) {
  alignas(32) static constexpr int32_t with[6][8] = {{2, 3, 0, 1, 6, 7, 4, 5}, {4, 5, 6, 7, 0, 1, 2, 3},
                                                     {1, 0, 3, 2, 5, 4, 7, 6}, {0, 1, 4, 5, 2, 3, 6, 7},
                                                     {0, 4, 2, 6, 1, 5, 3, 7}, {0, 2, 1, 4, 3, 6, 5, 7}};
  alignas(32) static constexpr int32_t smaller[6][8] = {{0, 0, -1, -1, 0, 0, -1, -1}, {0, 0, 0, 0, -1, -1, -1, -1},
                                                        {0, -1, 0, -1, 0, -1, 0, -1}, {0, 0, 0, 0, -1, -1, 0, 0},
                                                        {0, 0, 0, 0, -1, 0, -1, 0},   {0, 0, -1, 0, -1, 0, -1, 0}};
  for (int column = 0; column < 6; ++column) keys = exchange(Keys(), keys, with[column], smaller[column]);
  return keys;
}

/// The lanes of `values` in the mask moved down to the lowest lanes; lanes above hold no meaning.
HWY_INLINE WordLanes compress(WordLanes values, LaneMask lanes, uint32_t mask) {
#if HWY_TARGET == HWY_AVX3
  (void)mask;
  return hn::Compress(values, hn::RebindMask(Words(), lanes));
#else
  (void)lanes;
  const auto order = hn::PromoteTo(Words(), hn::LoadU(hn::FixedTag<uint8_t, 8>(), compress_table.lanes[mask].data()));
  return WordLanes{_mm256_permutevar8x32_epi32(values.raw, order.raw)};
#endif
}

/// The same with `filler` above.
HWY_INLINE hn::Vec<Keys> compress_over(hn::Vec<Keys> filler, WordLanes values, const NodeHits& hits) {
  const Keys d;
#if HWY_TARGET == HWY_AVX3
  return hn::Vec<Keys>{_mm256_mask_compress_epi32(filler.raw, hits.lanes.raw, values.raw)};
#else
  const auto count = hn::Set(d, static_cast<int32_t>(std::popcount(hits.mask)));
  const auto packed = hn::BitCast(d, compress(values, hits.lanes, hits.mask));
  return hn::IfThenElse(hn::Lt(hn::Iota(d, 0), count), packed, filler);
#endif
}

/// Keys of the children met, then -1, which is smaller than any key.
HWY_INLINE hn::Vec<Keys> compress_keys(const NodeHits& hits) {
  const Keys d;
  return compress_over(hn::Set(d, -1), hits.keys, hits);
}

/// Stores the references and distances that sorted keys stand for above the top of the stack.
HWY_INLINE void place_keys(hn::Vec<Keys> keys, const Node8& node, TraversalStack& stack) {
  const Words w;
  const WordLanes words = hn::BitCast(w, keys);
  const auto lane = hn::IndicesFromVec(w, hn::And(words, hn::Set(w, 7)));
  hn::StoreU(hn::TableLookupLanes(hn::Load(w, node.child), lane), w, stack.free_refs());
  hn::StoreU(hn::BitCast(Floats(), hn::And(words, hn::Set(w, ~7u))), Floats(), stack.free_nears());
}

/// See scalar::push_in_order(). Leaves distances alone: any-hit rays never cull by them.
HWY_INLINE void push_in_order(const NodeHits& hits, const Node8& node, TraversalStack& stack) {
  hn::StoreU(compress(hn::Load(Words(), node.child), hits.lanes, hits.mask), Words(), stack.free_refs());
  stack.grow(static_cast<uint32_t>(std::popcount(hits.mask)));
}

/// See scalar::nearest_child(). Without their order, which takes longer to find.
HWY_INLINE TraversalStack::Entry nearest_child(const NodeHits& hits, const Node8& node) {
  const Keys d;
  const auto none = hn::Set(d, std::numeric_limits<int32_t>::max());
  const auto keys = hn::IfThenElse(hn::RebindMask(d, hits.lanes), hn::BitCast(d, hits.keys), none);
  auto few = hn::Min(hn::LowerHalf(FewKeys(), keys), hn::UpperHalf(FewKeys(), keys));
  few = hn::Min(few, hn::Shuffle1032(few));
  const auto key = static_cast<uint32_t>(hn::GetLane(hn::Min(few, hn::Shuffle2301(few))));
  return {node.child[key & 7], std::bit_cast<float>(key & ~7u)};
}

/// See scalar::push_by_distance().
HWY_INLINE void push_by_distance(const NodeHits& hits, const Node8& node, TraversalStack& stack) {
  const auto count = static_cast<uint32_t>(std::popcount(hits.mask));
  const hn::Vec<Keys> keys = compress_keys(hits);
  if (HWY_LIKELY(count <= 4)) {
    const hn::Vec<FewKeys> few = sort_few(hn::LowerHalf(FewKeys(), keys));
    place_keys(hn::ZeroExtendVector(Keys(), few), node, stack);
  } else {
    place_keys(sort_many(keys), node, stack);
  }
  stack.grow(count);
}

/// See scalar::drop_farther().
HWY_INLINE void drop_farther(TraversalStack& stack, uint32_t base, float t_far) {
  const Floats d;
  const Words w;
  uint32_t kept = base;
  const uint32_t size = stack.size();
  for (uint32_t i = base; i < size; i += 8) {
    const FloatLanes nears = hn::LoadU(d, stack.nears() + i);
    const WordLanes refs = hn::LoadU(w, stack.refs() + i);
    const LaneMask keep = hn::And(hn::Le(nears, hn::Set(d, t_far)), hn::FirstN(d, size - i));
    const uint32_t mask = mask_bits(keep);
    hn::StoreU(hn::BitCast(d, compress(hn::BitCast(w, nears), keep, mask)), d, stack.nears() + kept);
    hn::StoreU(compress(refs, keep, mask), w, stack.refs() + kept);
    kept += static_cast<uint32_t>(std::popcount(mask));
  }
  stack.resize(kept);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
