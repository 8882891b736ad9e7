// The corners of the triangles that the rays of a packet hit. Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_CORNERS_INL_H_
#undef RAYLOOM_ACCEL_PACKET_CORNERS_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_CORNERS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_doubles-inl.h>
#include <rayloom/accel/triangle_leaf.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// The corners of one triangle, for all rays.
struct CommonCorners {
  HWY_INLINE CommonCorners(const TriangleLeaf& leaf, uint32_t lane) {
    for (uint32_t corner = 0; corner < 3; ++corner)
      for (uint32_t k = 0; k < 3; ++k) at_[corner][k] = leaf.coordinate(corner, k, lane);
  }
  template <int half>
  HWY_INLINE DoubleVector3 corner(int i) const {
    return splat(at_[i]);
  }

 private:
  float at_[3][3];
};

/// Sixteen floats, one for each ray; indices are taken modulo sixteen.
HWY_INLINE PacketVector look_up_sixteen(const float* table, PacketWordVector index) {
#if HWY_TARGET == HWY_AVX3
  return PacketVector{_mm512_permutexvar_ps(index.raw, hn::LoadU(PacketFloats(), table).raw)};
#else
  return look_up(hn::LoadU(Floats(), table), hn::LoadU(Floats(), table + 8), index);
#endif
}

/// One of eight words for each ray.
HWY_INLINE PacketWordVector look_up_eight(WordLanes table, PacketWordVector index) {
#if HWY_TARGET == HWY_AVX3
  return PacketWordVector{_mm512_permutexvar_epi32(index.raw, hn::ZeroExtendVector(PacketWords(), table).raw)};
#else
  return PacketWordVector{_mm256_permutevar8x32_epi32(table.raw, index.raw)};
#endif
}

/// The corners of a triangle of each ray's own, all of one leaf.
struct OwnCorners {
  HWY_INLINE OwnCorners(const TriangleLeaf& leaf, PacketWordVector lane) {
    const size_t third = third_vertices(leaf);
    for (size_t i = 0; i < 3; ++i) {
      const auto corners = hn::PromoteTo(Words(), hn::LoadU(hn::FixedTag<uint8_t, 8>(), leaf.corner[i]));
      const PacketWordVector index = look_up_eight(corners, lane);
      for (uint32_t k = 0; k < 3; ++k) at_[i][k] = look_up_sixteen(leaf.row(k) + (i == 2 ? third : 0), index);
    }
  }
  template <int half>
  HWY_INLINE DoubleVector3 corner(int i) const {
    return promote_half<half>(at_[i]);
  }

 private:
  PacketVector at_[3][3];
};

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
