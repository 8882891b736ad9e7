// Which corners of eight triangles are one vertex; re-included once per target by Highway's foreach_target.h.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_EQUAL_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_EQUAL_CORNERS_INL_H_
#undef RAYLOOM_ACCEL_EQUAL_CORNERS_INL_H_
#else
#define RAYLOOM_ACCEL_EQUAL_CORNERS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/triangle_lanes-inl.h>

#include <array>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2

/// Where `some` equals `other`, whose corners are numbered `number`, the lower number.
HWY_INLINE void lower(WordLanes some, WordLanes other, WordLanes number, WordLanes& first) {
  first = hn::IfThenElse(hn::Eq(some, other), hn::Min(first, number), first);
}

/// Compares corners whose lanes are `turn` and more apart. Unrolled by hand: all of it has to stay in registers.
template <uint32_t turn>
HWY_INLINE void compare_turned(const IndexLanes& indices, IndexLanes& first) {
  const Words d;
  const auto& [v0, v1, v2] = indices.vertex;
  const WordLanes lane = hn::And(hn::Iota(d, turn), hn::Set(d, triangle_lanes - 1)),
                  lane1 = hn::Add(lane, hn::Set(d, triangle_lanes));
  const auto order = hn::IndicesFromVec(d, lane);
  const WordLanes turned0 = hn::TableLookupLanes(v0, order), turned1 = hn::TableLookupLanes(v1, order);
  if constexpr (turn > 0) {
    lower(v0, turned0, lane, first.vertex[0]);
    lower(v1, turned1, lane1, first.vertex[1]);
    lower(v2, hn::TableLookupLanes(v2, order), hn::Add(lane1, hn::Set(d, triangle_lanes)), first.vertex[2]);
  }
  lower(v1, turned0, lane, first.vertex[1]);
  lower(v2, turned0, lane, first.vertex[2]);
  lower(v2, turned1, lane1, first.vertex[2]);
  if constexpr (turn + 1 < triangle_lanes) compare_turned<turn + 1>(indices, first);
}

/// Every corner's first equal one; corners are numbered 8 * vertex + lane.
HWY_INLINE IndexLanes first_equal(const IndexLanes& indices) {
  const Words d;
  IndexLanes first{{hn::Iota(d, 0), hn::Iota(d, triangle_lanes), hn::Iota(d, 2 * triangle_lanes)}};
  compare_turned<0>(indices, first);
  return first;
}

#elif HWY_TARGET == HWY_AVX3

/// Two vertices of eight triangles.
using Words16 = hn::FixedTag<uint32_t, 16>;
using PairLanes = hn::Vec<Words16>;

/// Corner numbers, and by turn the lanes that come so much later in their half.
struct TurnTable {
  alignas(64) std::array<std::array<uint32_t, 16>, triangle_lanes> lane, lane_of_0_and_2;
};
inline constexpr TurnTable turn_table = [] {
  TurnTable table{};
  for (uint32_t turn = 0; turn < triangle_lanes; ++turn)
    for (uint32_t i = 0; i < 16; ++i) {
      const uint32_t half = i & triangle_lanes;
      table.lane[turn][i] = half | ((i + turn) & (triangle_lanes - 1));
      table.lane_of_0_and_2[turn][i] = table.lane[turn][i] + half;
    }
  return table;
}();

/// Corners' numbers, lowered as equal ones are found.
struct FirstCorners {
  PairLanes of01, of12, of22;
};

HWY_INLINE void lower(PairLanes some, PairLanes other, PairLanes number, PairLanes& first) {
  first = hn::IfThenElse(hn::Eq(some, other), hn::Min(first, number), first);
}

/// Compares corners whose lanes are `turn` and more apart: each vertex with those of lower number and with itself.
template <uint32_t turn>
HWY_INLINE void compare_turned(PairLanes v01, PairLanes v02, PairLanes v12, PairLanes v22, FirstCorners& first) {
  const Words16 d;
  const PairLanes lane = hn::Load(d, turn_table.lane[turn].data()),
                  lane02 = hn::Load(d, turn_table.lane_of_0_and_2[turn].data());
  const auto order = hn::IndicesFromVec(d, lane);
  const PairLanes turned = hn::TableLookupLanes(v01, order);
  if constexpr (turn > 0) lower(v01, turned, lane, first.of01);
  lower(v22, turned, lane, first.of22);
  lower(v12, hn::TableLookupLanes(v02, order), lane02, first.of12);
  if constexpr (turn + 1 < triangle_lanes) compare_turned<turn + 1>(v01, v02, v12, v22, first);
}

/// Every corner's first equal one; corners are numbered 8 * vertex + lane.
HWY_INLINE IndexLanes first_equal(const IndexLanes& indices) {
  const Words d;
  const Words16 pairs;
  const auto& [v0, v1, v2] = indices.vertex;
  const WordLanes own0 = hn::Iota(d, 0), own1 = hn::Iota(d, triangle_lanes), own2 = hn::Iota(d, 2 * triangle_lanes);
  FirstCorners first{hn::Combine(pairs, own1, own0), hn::Combine(pairs, own2, own1), hn::Combine(pairs, own2, own2)};
  compare_turned<0>(hn::Combine(pairs, v1, v0), hn::Combine(pairs, v2, v0), hn::Combine(pairs, v2, v1),
                    hn::Combine(pairs, v2, v2), first);
  const WordLanes of2 = hn::Min(hn::LowerHalf(d, first.of22), hn::UpperHalf(d, first.of22));
  return {{hn::LowerHalf(d, first.of01), hn::Min(hn::UpperHalf(d, first.of01), hn::LowerHalf(d, first.of12)),
           hn::Min(of2, hn::UpperHalf(d, first.of12))}};
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // RAYLOOM_ACCEL_EQUAL_CORNERS_INL_H_
