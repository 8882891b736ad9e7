// References to triangles in the order of their keys, eight at a time, re-included once per target by Highway's
// foreach_target.h. The bits are those of TriangleCurve::gather's other loop.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_TRIANGLE_REFS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_TRIANGLE_REFS_INL_H_
#undef RAYLOOM_ACCEL_TRIANGLE_REFS_INL_H_
#else
#define RAYLOOM_ACCEL_TRIANGLE_REFS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/read_ahead.h>
#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/accel/simd/triangle_lanes-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// One half of eight references, two in each vector: i and i + 4.
struct HalfRefs {
  HWY_INLINE HalfRefs(const PointLanes& point, WordLanes name) {
    const Floats d;
    const hn::FixedTag<double, 4> pairs;
    const auto& [x, y, z] = point.axis;
    const auto w = hn::BitCast(d, name);
    const auto xy_low = hn::BitCast(pairs, hn::InterleaveLower(d, x, y)),
               xy_high = hn::BitCast(pairs, hn::InterleaveUpper(d, x, y)),
               zw_low = hn::BitCast(pairs, hn::InterleaveLower(d, z, w)),
               zw_high = hn::BitCast(pairs, hn::InterleaveUpper(d, z, w));
    of0 = hn::BitCast(d, hn::InterleaveLower(pairs, xy_low, zw_low));
    of1 = hn::BitCast(d, hn::InterleaveUpper(pairs, xy_low, zw_low));
    of2 = hn::BitCast(d, hn::InterleaveLower(pairs, xy_high, zw_high));
    of3 = hn::BitCast(d, hn::InterleaveUpper(pairs, xy_high, zw_high));
  }
  FloatLanes of0, of1, of2, of3;
};

HWY_INLINE void store_two(FloatLanes min, FloatLanes max, PrimitiveRef* refs) {
  const Floats d;
  hn::StoreU(hn::ConcatLowerLower(d, max, min), d, refs[0].min);
  hn::StoreU(hn::ConcatUpperUpper(d, max, min), d, refs[4].min);
}

HWY_INLINE void store_eight(const ExtentLanes& box, WordLanes geometry, WordLanes primitive, PrimitiveRef* refs) {
  const HalfRefs min(box.min, geometry), max(box.max, primitive);
  store_two(min.of0, max.of0, refs);
  store_two(min.of1, max.of1, refs + 1);
  store_two(min.of2, max.of2, refs + 2);
  store_two(min.of3, max.of3, refs + 3);
}

/// Keys in their order, in blocks of eight. Of later blocks indices are read, and of still later ones asked for.
class RefGatherer {
 public:
  HWY_INLINE RefGatherer(const RefRange& range, std::span<const MortonKey> keys, const TriangleRows* rows)
      : range_(range), reader_(*range.geometry), keys_(keys), rows_(rows) {}

  HWY_INLINE void gather_all(PrimitiveRef* refs) {
    for (size_t first = 0; first < std::min(ahead, keys_.size()); first += triangle_lanes) read_indices(first);
    for (size_t first = 0; first < keys_.size(); first += triangle_lanes) {
      const IndexLanes indices = read_[first % ahead / triangle_lanes];
      if (first + ahead < keys_.size()) read_indices(first + ahead);
      if (rows_) store_rows(indices, first);
      const ExtentLanes box = box_of(reader_.corners(indices));
      const WordLanes geometry = hn::Set(Words(), range_.index);
      const size_t left = keys_.size() - first;
      if (left >= triangle_lanes) {
        store_eight(box, geometry, primitives(first), refs + first);
      } else {
        PrimitiveRef last[triangle_lanes];
        store_eight(box, geometry, primitives(first), last);
        std::copy_n(last, left, refs + first);
      }
    }
  }

 private:
  static constexpr size_t ahead = 4 * triangle_lanes;

  /// Lanes beyond the end repeat the first key's.
  HWY_INLINE WordLanes primitives(size_t first) const {
    const Words d;
    WordLanes code, number;
    const auto* const from = reinterpret_cast<const uint32_t*>(keys_.data() + first);
    if (first + triangle_lanes <= keys_.size()) {
      hn::LoadInterleaved2(d, from, code, number);
    } else {
      const auto used = hn::FirstN(d, keys_.size() - first);
      const auto place = hn::IfThenElseZero(used, hn::Mul(hn::Iota(d, 0), hn::Set(d, sizeof(MortonKey))));
      number = hn::GatherOffset(d, &keys_[first].index, hn::BitCast(Ints(), place));
    }
    return hn::Sub(number, hn::Set(d, range_.first_number));
  }

  HWY_INLINE void store_rows(const IndexLanes& indices, size_t first) const {
    const Words d;
    hn::StoreU(primitives(first), d, rows_->primitive + first);
    for (int v = 0; v < 3; ++v) hn::StoreU(indices.vertex[v], d, rows_->vertex[v] + first);
  }

  /// Of each triangle the first vertex is asked for: where triangles lie side by side, that brings the others.
  HWY_INLINE void read_indices(size_t first) {
    read_ahead(&keys_[first]);
    ask_for_indices(first + ahead);
    const IndexLanes indices = read_[first % ahead / triangle_lanes] = reader_.indices(primitives(first));
    uint32_t vertex[triangle_lanes];
    hn::StoreU(indices.vertex[0], Words(), vertex);
    for (const uint32_t index : vertex) ask_for_vertex(index);
  }

  /// The address is a number, not a pointer: an index may be out of range. Of a stride 32 bits count (BI-05).
  HWY_INLINE void ask_for_vertex(uint32_t index) const {
    const TriangleGeometry& geometry = *range_.geometry;
    const auto first = reinterpret_cast<uintptr_t>(geometry.vertices);
    const uint64_t offset = uint64_t{index} * static_cast<uint32_t>(geometry.vertex_stride);
    __builtin_prefetch(reinterpret_cast<const void*>(first + offset));
  }

  HWY_INLINE void ask_for_indices(size_t first) const {
    const std::byte* const indices = range_.geometry->indices;
    for (size_t i = first; i < std::min<size_t>(first + triangle_lanes, keys_.size()); ++i)
      __builtin_prefetch(indices + 12 * size_t{keys_[i].index - range_.first_number});
  }

  const RefRange& range_;
  TriangleReader reader_;
  std::span<const MortonKey> keys_;
  const TriangleRows* rows_;
  IndexLanes read_[ahead / triangle_lanes];  ///< of the blocks that come next
};

void gather_refs(const RefRange& range, std::span<const MortonKey> keys, PrimitiveRef* refs, const TriangleRows* rows) {
  RefGatherer(range, keys, rows).gather_all(refs);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // RAYLOOM_ACCEL_TRIANGLE_REFS_INL_H_
