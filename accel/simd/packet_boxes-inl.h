// Box tests of packets. Unlike those of lanes-inl.h they have no plain twin to agree with: a packet visits other boxes
// than a single ray does, and finds the same hits, since no box of a hit is missed (docs/numerics.md, "Packets").
// Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_BOXES_INL_H_
#undef RAYLOOM_ACCEL_PACKET_BOXES_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_BOXES_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_row-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// Box tests for all rays at once: planes are taken relative to the origin, moved outward, and times either end of the
/// widened range of reciprocals.
struct SharedBoxes {
  FloatLanes near_corner[3], far_corner[3], least[3], most[3];
  uint32_t near_row[4];
};

/// Entries of eight boxes, and which of them any of the rays may meet in [t_near, t_far].
struct PacketBoxHits {
  FloatLanes entry;
  uint32_t mask;
};

HWY_INLINE PacketBoxHits test_boxes(const SharedBoxes& rays, const Node8& node, FloatLanes t_near, FloatLanes t_far) {
  const Floats d;
  FloatLanes entry = t_near, exit = t_far;
  const float* const planes = &node.bounds[0][0][0];
  for (int k = 0; k < 3; ++k) {
    const FloatLanes near = hn::Sub(hn::Load(d, planes + rays.near_row[k]), rays.near_corner[k]);
    const FloatLanes far = hn::Sub(hn::Load(d, planes + (rays.near_row[k] ^ 8)), rays.far_corner[k]);
    entry = hn::Max(entry, hn::Min(hn::Mul(near, rays.least[k]), hn::Mul(near, rays.most[k])));
    exit = hn::Min(exit, hn::Max(hn::Mul(far, rays.least[k]), hn::Mul(far, rays.most[k])));
  }
  return {entry, mask_bits(hn::Le(entry, exit))};
}

/// The rays of a row that meet one child's box: test_node() for one box and many rays.
HWY_INLINE uint32_t test_child(const SharedBoxes& shared, const PacketRow& row, const Node8& node, int lane,
                               PacketVector t_near, PacketVector t_far) {
  const float* const planes = &node.bounds[0][0][lane];
  PacketVector entry[3], exit[3];
  for (int k = 0; k < 3; ++k) {
    entry[k] = hn::MulAdd(splat(planes[shared.near_row[k]]), row.reciprocal[k], row.near_offset[k]);
    exit[k] = hn::MulAdd(splat(planes[shared.near_row[k] ^ 8]), row.reciprocal[k], row.far_offset[k]);
  }
  return packet_bits(hn::Le(hn::Max(hn::Max(entry[0], entry[1]), hn::Max(entry[2], t_near)),
                            hn::Min(hn::Min(exit[0], exit[1]), hn::Min(exit[2], t_far))));
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
