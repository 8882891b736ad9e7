// A row of a packet: a vector of rays of nearly the same direction. Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_ROW_INL_H_
#undef RAYLOOM_ACCEL_PACKET_ROW_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_ROW_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_vectors-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// A vector of rays, and what tests of single boxes need of each. Lanes of rays that are not part of a packet repeat
/// one that is.
struct PacketRow {
  /// From ray `begin` of a group on; its last one stands for those that are not there.
  HWY_INLINE void load(const RayRun& group, size_t begin) {
    PacketVector four[4];
    load_four(group, begin, 0, four);
    for (int k = 0; k < 3; ++k) origin[k] = four[k];
    t_min = four[3];
    load_four(group, begin, 4, four);
    for (int k = 0; k < 3; ++k) direction[k] = four[k];
    t_max = four[3];
  }

  /// traceable(), of directions that are neither long nor short. The origin is looked at elsewhere.
  HWY_INLINE PacketMask moderate(uint32_t dominant_axis) const {
    PacketMask good = hn::And(hn::Ge(t_min, splat(0)), hn::Le(t_min, t_max));
    const PacketVector dominant = hn::Abs(direction[dominant_axis]);
    good = hn::And(good, hn::Ge(dominant, splat(shortest_direction)));
    good = hn::And(good, hn::Le(dominant, splat(longest_direction)));
    for (const PacketVector& component : direction) good = hn::And(good, hn::Le(hn::Abs(component), dominant));
    return good;
  }

  HWY_INLINE PacketMask same_octant(const float* first) const {
    const hn::RebindToSigned<PacketFloats> w;
    PacketVector differences = hn::Xor(direction[0], splat(first[0]));
    for (int k = 1; k < 3; ++k) differences = hn::Or(differences, hn::Xor(direction[k], splat(first[k])));
    return hn::Not(hn::RebindMask(PacketFloats(), hn::Lt(hn::BitCast(w, differences), hn::Zero(w))));
  }

  HWY_INLINE PacketMask within(const Ray& first, float distance) const {
    PacketMask good = hn::Eq(t_min, t_min);
    for (int k = 0; k < 3; ++k)
      good = hn::And(good, hn::Le(hn::Abs(hn::Sub(direction[k], splat(first.direction[k]))), splat(distance)));
    return good;
  }

  HWY_INLINE PacketMask same_origin(const Ray& first) const {
    const auto at = [&](int k) HWY_ATTR { return hn::Eq(origin[k], splat(first.origin[k])); };
    return hn::And(at(0), hn::And(at(1), at(2)));
  }

  /// Fills the lanes of rays that are not `taken`.
  HWY_INLINE void repeat(const Ray& first, uint32_t taken) {
    if (taken == all_rays) return;
    const PacketMask mask = packet_mask(taken);
    for (int k = 0; k < 3; ++k) {
      origin[k] = hn::IfThenElse(mask, origin[k], splat(first.origin[k]));
      direction[k] = hn::IfThenElse(mask, direction[k], splat(first.direction[k]));
    }
    t_min = hn::IfThenElse(mask, t_min, splat(first.t_min));
    t_max = hn::IfThenElse(mask, t_max, splat(first.t_max));
  }

  /// `scale` of directions, `shortest` of their components then; `pad` by axis.
  HWY_INLINE void prepare_boxes(const float* pad, float scale, float shortest) {
    for (int k = 0; k < 3; ++k) {
      const PacketVector component = hn::Abs(hn::Mul(direction[k], splat(scale)));
      const PacketVector magnitude = hn::Div(splat(1), hn::Max(component, splat(shortest)));
      reciprocal[k] = hn::CopySign(magnitude, direction[k]);
      const PacketVector centre = hn::Mul(hn::Neg(origin[k]), reciprocal[k]);
      near_offset[k] = hn::NegMulAdd(splat(pad[k]), magnitude, centre);
      far_offset[k] = hn::MulAdd(splat(pad[k]), magnitude, centre);
    }
  }

  HWY_INLINE Ray ray(uint32_t lane) const {
    const auto at = [&](const PacketVector& v) { return reinterpret_cast<const float*>(&v)[lane]; };
    return {{at(origin[0]), at(origin[1]), at(origin[2])},
            at(t_min),
            {at(direction[0]), at(direction[1]), at(direction[2])},
            at(t_max)};
  }

  PacketVector direction[3], t_min, t_max;
  PacketVector origin[3];
  PacketVector reciprocal[3], near_offset[3], far_offset[3];  ///< as in PreparedRay

 private:
  static constexpr float longest_direction = 0x1p60f, shortest_direction = 0x1p-60f;
};

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
