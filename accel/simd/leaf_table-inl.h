// A leaf's vertices, each once, in vectors; re-included once per target by Highway's foreach_target.h. The bytes are
// those of triangle_leaf.cpp's loop over indices.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_LEAF_TABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_LEAF_TABLE_INL_H_
#undef RAYLOOM_ACCEL_LEAF_TABLE_INL_H_
#else
#define RAYLOOM_ACCEL_LEAF_TABLE_INL_H_
#endif
// clang-format on

#include <rayloom/accel/layout.h>
#include <rayloom/accel/primitive_ref.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/accel/simd/compress_table.h>
#include <rayloom/accel/simd/equal_corners-inl.h>
#include <rayloom/accel/simd/prefix_counts.h>
#include <rayloom/accel/simd/triangle_lanes-inl.h>

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

using Bytes8 = hn::FixedTag<uint8_t, 8>;
using Bytes16 = hn::FixedTag<uint8_t, 16>;

/// Which corners are the first of their vertex, a bit each.
struct FirstOnes {
  uint32_t bits[3];  ///< by vertex
  uint32_t count[3];
  uint32_t slots() const { return count[0] + count[1] + count[2]; }
};

template <uint32_t vertex>
HWY_INLINE void find_first_ones(const IndexLanes& first, uint32_t used, FirstOnes& ones) {
  const auto is_first = hn::Eq(first.vertex[vertex], hn::Iota(Words(), triangle_lanes * vertex));
  ones.bits[vertex] = mask_bits(hn::RebindMask(Floats(), is_first)) & used;
  ones.count[vertex] = static_cast<uint32_t>(std::popcount(ones.bits[vertex]));
}

/// What corners look their entries up in: those of the first corners, in the order of their numbers.
struct EntryTable {
  HWY_INLINE explicit EntryTable(const FirstOnes& ones) {
    constexpr uint64_t each = 0x0101010101010101u;
    const hn::FixedTag<uint64_t, 1> one;
    const hn::FixedTag<uint64_t, 2> two;
    const uint64_t entry1 = prefix_counts[ones.bits[1]] + each * ones.count[0],
                   entry2 = prefix_counts[ones.bits[2]] + each * (ones.count[0] + ones.count[1]);
    low = hn::BitCast(Bytes16(), hn::Combine(two, hn::Set(one, entry1), hn::Set(one, prefix_counts[ones.bits[0]])));
    high = hn::BitCast(Bytes16(), hn::Set(two, entry2));
  }

  HWY_INLINE uint64_t entries(WordLanes first) const {
    const Bytes16 d;
    const auto number = hn::ZeroExtendVector(d, hn::DemoteTo(Bytes8(), hn::BitCast(Ints(), first)));
    const auto place = hn::And(number, hn::Set(d, uint8_t{15}));
    const auto found =
        hn::IfThenElse(hn::Eq(number, place), hn::TableLookupBytes(low, place), hn::TableLookupBytes(high, place));
    return hn::GetLane(hn::BitCast(hn::FixedTag<uint64_t, 2>(), found));
  }

  hn::Vec<Bytes16> low, high;
};

/// Each corner's entry of the table; 0 for unused lanes.
HWY_INLINE void write_corners(const IndexLanes& first, const FirstOnes& ones, size_t count, uint8_t (&corner)[3][8]) {
  const EntryTable table(ones);
  const uint64_t keep = ~uint64_t{0} >> (64 - 8 * count);
  const uint64_t entries[3] = {table.entries(first.vertex[0]) & keep, table.entries(first.vertex[1]) & keep,
                               table.entries(first.vertex[2]) & keep};
  std::memcpy(corner, entries, sizeof(entries));
}

/// The lanes of `bits` together, from lane `to` on and around.
HWY_INLINE WordLanes compressed(WordLanes from, uint32_t bits, uint32_t to) {
  const Words d;
  const WordLanes lane = hn::PromoteTo(d, hn::LoadU(Bytes8(), compress_table.lanes[bits].data()));
  const WordLanes turn = hn::And(hn::Sub(hn::Iota(d, 0), hn::Set(d, to)), hn::Set(d, triangle_lanes - 1));
  const WordLanes order = hn::TableLookupLanes(lane, hn::IndicesFromVec(d, turn));
  return hn::TableLookupLanes(from, hn::IndicesFromVec(d, order));
}

/// The table's coordinates: 16 entries a row, of which the next row takes back those that are too many.
HWY_INLINE void write_rows(const TriangleReader& reader, const IndexLanes& indices, const FirstOnes& ones, float* row) {
  const Words d;
  const uint32_t end0 = ones.count[0], end1 = end0 + ones.count[1], slots = ones.slots();
  const WordLanes part0 = compressed(indices.vertex[0], ones.bits[0], 0),
                  part1 = compressed(indices.vertex[1], ones.bits[1], end0),
                  part2 = compressed(indices.vertex[2], ones.bits[2], end1);
  const WordLanes slot = hn::Iota(d, 0), later = hn::Iota(d, triangle_lanes);
  const WordLanes others = hn::IfThenElse(hn::Lt(slot, hn::Set(d, end1)), part1, part2);
  const PointLanes low = reader.vertex(hn::IfThenElse(hn::Lt(slot, hn::Set(d, end0)), part0, others));
  const PointLanes high = reader.vertex(hn::IfThenElse(hn::Lt(later, hn::Set(d, end1)), part1, part2));
  hn::StoreU(low.axis[0], Floats(), row);
  hn::StoreU(high.axis[0], Floats(), row + triangle_lanes);
  hn::StoreU(low.axis[1], Floats(), row + slots);
  hn::StoreU(high.axis[1], Floats(), row + slots + triangle_lanes);
  hn::StoreU(low.axis[2], Floats(), row + 2 * slots);
  hn::StoreU(high.axis[2], Floats(), row + 2 * slots + triangle_lanes);
}

/// A leaf's triangles in their final order; lanes that are not used repeat one that is.
HWY_INLINE uint32_t write_triangles(const TriangleReader& reader, WordLanes primitive, const IndexLanes& indices,
                                    size_t count, TriangleLeaf& leaf) {
  const Words d;
  const IndexLanes first = first_equal(indices);
  const uint32_t used_bits = (1u << count) - 1;
  FirstOnes ones;
  find_first_ones<0>(first, used_bits, ones);
  find_first_ones<1>(first, used_bits, ones);
  find_first_ones<2>(first, used_bits, ones);
  const uint32_t slots = ones.slots();
  if (slots > TriangleLeaf::table_slots) return slots;
  write_corners(first, ones, count, leaf.corner);
  leaf.count = static_cast<uint8_t>(count);
  leaf.slots = static_cast<uint8_t>(slots);
  leaf.mixed = leaf.reserved = 0;
  hn::StoreU(hn::IfThenElse(hn::FirstN(d, count), primitive, hn::Set(d, no_index)), d, leaf.primitive);
  write_rows(reader, indices, ones, reinterpret_cast<float*>(&leaf + 1));
  return slots;
}

uint32_t write_table_leaf(const TriangleGeometry& geometry, std::span<const PrimitiveRef> refs, TriangleLeaf& leaf) {
  const Words d;
  const TriangleReader reader(geometry);
  const auto used = hn::FirstN(d, refs.size());
  const auto place = hn::IfThenElseZero(used, hn::Mul(hn::Iota(d, 0), hn::Set(d, sizeof(PrimitiveRef))));
  const WordLanes primitive = hn::GatherOffset(d, &refs[0].primitive, hn::BitCast(Ints(), place));
  return write_triangles(reader, primitive, reader.indices(primitive), refs.size(), leaf);
}

/// Lanes compared with partners of theirs: the lower value goes to the lane that comes first.
struct Compared {
  HWY_INLINE Compared(WordLanes value, WordLanes partner)
      : low(hn::Min(value, partner)), high(hn::Max(value, partner)) {}
  HWY_INLINE WordLanes by_one() const { return hn::OddEven(high, low); }
  HWY_INLINE WordLanes by_two() const {
    const hn::FixedTag<uint64_t, 4> twos;
    return hn::BitCast(Words(), hn::OddEven(hn::BitCast(twos, high), hn::BitCast(twos, low)));
  }
  HWY_INLINE WordLanes by_four() const { return hn::ConcatUpperLower(Words(), high, low); }

  WordLanes low, high;
};

/// Ascending, by a bitonic network (Batcher 1968) whose merges begin with one half reversed.
HWY_INLINE WordLanes sorted(WordLanes value) {
  value = Compared(value, hn::Shuffle2301(value)).by_one();
  value = Compared(value, hn::Shuffle0123(value)).by_two();
  value = Compared(value, hn::Shuffle2301(value)).by_one();
  value = Compared(value, hn::Reverse(Words(), value)).by_four();
  value = Compared(value, hn::Shuffle1032(value)).by_two();
  return Compared(value, hn::Shuffle2301(value)).by_one();
}

/// Primitives are below 2^29 (vectors_read), so that a lane's number fits below its primitive's.
uint32_t write_leaf_of_rows(const TriangleGeometry& geometry, const TriangleRows& rows, size_t first, size_t count,
                            TriangleLeaf& leaf) {
  const Words d;
  constexpr int lane_bits = 3;
  const auto lane = hn::Set(d, triangle_lanes - 1);
  const WordLanes primitive = hn::LoadU(d, rows.primitive + first);
  const WordLanes named = hn::Or(hn::ShiftLeft<lane_bits>(primitive), hn::Iota(d, 0));
  const WordLanes name = sorted(hn::IfThenElse(hn::FirstN(d, count), named, hn::AndNot(lane, hn::Set(d, ~0u))));
  const auto order = hn::IndicesFromVec(d, hn::And(name, lane));
  const IndexLanes indices{{hn::TableLookupLanes(hn::LoadU(d, rows.vertex[0] + first), order),
                            hn::TableLookupLanes(hn::LoadU(d, rows.vertex[1] + first), order),
                            hn::TableLookupLanes(hn::LoadU(d, rows.vertex[2] + first), order)}};
  return write_triangles(TriangleReader(geometry), hn::ShiftRight<lane_bits>(name), indices, count, leaf);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // RAYLOOM_ACCEL_LEAF_TABLE_INL_H_
