// Packets of rays that leave neighbouring points: shadow rays of one light. Each tests triangles by itself, with what a
// PreparedRay would hold, made for all of them at once.
// Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_BUNDLE_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_BUNDLE_RAYS_INL_H_
#undef RAYLOOM_ACCEL_BUNDLE_RAYS_INL_H_
#else
#define RAYLOOM_ACCEL_BUNDLE_RAYS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_rays-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

class BundleRays : public PacketRays<1> {
 public:
  static constexpr float largest_difference = 0.25f;  ///< of two directions, over the dominant component

  /// Takes on the first of the `wanted` rays and those that go with it; returns them. 0: too few of them do, or they
  /// have extreme coordinates; nothing else may be asked then.
  HWY_INLINE uint32_t load(const RayRun& rays, uint32_t wanted, const StructureHeader& header) {
    read(rays);
    const Ray first = begin(wanted);
    const uint32_t taken = wanted & packet_bits(hn::And(alike(0, first, largest_difference), near(first, header)));
    if (std::popcount(taken) < fewest || (taken & (wanted & -wanted)) == 0) return 0;
    row[0].repeat(first, taken);
    if (!prepare(first, range_of(row[0].origin), largest_angle, header, 1)) return 0;
    prepare_triangles();
    return taken;
  }

  const uint32_t (&axes() const)[3] { return axis_; }
  /// TriangleLanes of one ray's PreparedRay.
  HWY_INLINE TriangleLanes lanes(uint32_t ray) const {
    const Floats d;
    TriangleLanes lanes;
    for (uint32_t i = 0; i < 3; ++i) {
      lanes.axis[i] = axis_[i];
      lanes.origin[i] = hn::Set(d, ordered_origin_[i][ray]);
    }
    for (int i = 0; i < 2; ++i) lanes.shear[i] = hn::Set(d, shear_[i][ray]);
    return lanes;
  }
  /// One ray's DepthInterval.
  HWY_INLINE DepthLimits depths(uint32_t ray) const {
    return {outer_near_[ray], outer_far_[ray], inner_near_[ray], inner_far_[ray], sign_};
  }

 private:
  /// Origins not far from the first one's.
  HWY_INLINE PacketMask near(const Ray& first, const StructureHeader& header) const {
    PacketMask good = hn::Eq(row[0].t_min, row[0].t_min);
    for (int k = 0; k < 3; ++k) {
      const float distance = largest_distance * (header.bounds_max[k] - header.bounds_min[k]);
      good = hn::And(good, hn::Le(hn::Abs(hn::Sub(row[0].origin[k], splat(first.origin[k]))), splat(distance)));
    }
    return good;
  }

  HWY_INLINE void prepare_triangles() {
    const PacketFloats d;
    for (uint32_t i = 0; i < 3; ++i) {
      axis_[i] = axis_after(i);
      hn::Store(row[0].origin[axis_[i]], d, ordered_origin_[i]);
    }
    for (uint32_t i = 0; i < 2; ++i)
      hn::Store(hn::Div(row[0].direction[axis_[i]], row[0].direction[dominant_]), d, shear_[i]);
    const PacketVector length = hn::Abs(row[0].direction[dominant_]);
    sign_ = std::copysign(0.0f, hn::GetLane(row[0].direction[dominant_]));
    const PacketVector tiny = hn::Mul(splat(DepthInterval::tiny), hn::Add(length, splat(1)));
    const PacketVector less = splat(DepthInterval::less), more = splat(DepthInterval::more);
    const PacketVector nearest = hn::Mul(row[0].t_min, length);
    const PacketVector farthest = hn::Mul(hn::Min(row[0].t_max, splat(std::numeric_limits<float>::max())), length);
    hn::Store(hn::Sub(hn::Mul(nearest, less), tiny), d, outer_near_);
    hn::Store(hn::Add(hn::Mul(nearest, more), tiny), d, inner_near_);
    hn::Store(hn::Add(hn::Mul(farthest, more), tiny), d, outer_far_);
    hn::Store(hn::Sub(hn::Mul(farthest, less), tiny), d, inner_far_);
  }

  static constexpr int fewest = packet_size / 2;
  static constexpr float largest_angle = 0.5f;
  static constexpr float largest_distance = 0x1p-3f;  ///< of two origins, over the structure's size

  alignas(64) float ordered_origin_[3][packet_size], shear_[2][packet_size];
  alignas(64) float outer_near_[packet_size], outer_far_[packet_size];
  alignas(64) float inner_near_[packet_size], inner_far_[packet_size];
  float sign_;
  uint32_t axis_[3];
};

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
