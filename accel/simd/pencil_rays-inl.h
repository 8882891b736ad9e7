// Packets of rays that leave one point: they share what a triangle is from there.
// Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PENCIL_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PENCIL_RAYS_INL_H_
#undef RAYLOOM_ACCEL_PENCIL_RAYS_INL_H_
#else
#define RAYLOOM_ACCEL_PENCIL_RAYS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_doubles-inl.h>
#include <rayloom/accel/simd/packet_rays-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// Several rows of rays: a node or a leaf is looked at once for all of them, and what depends on one another within a
/// row overlaps with the other's.
class PencilRays : public PacketRays<32 / packet_size> {
 public:
  /// Rays of a packet in an instance's space.
  struct InInstance {
    const PencilRays& world;
    const InstanceRecord* instance;  ///< null: one that leaves them as they are
  };

  /// Takes on the first of the `wanted` rays and those that go with it; returns them. 0: too few of them do, or they
  /// have extreme coordinates; nothing else may be asked then. Rays: a RayRun, or InInstance with rays that the other
  /// packet has taken on.
  template <class Rays>
  HWY_INLINE uint32_t load(const Rays& rays, uint32_t wanted, const StructureHeader& header, float pad_scale) {
    read(rays);
    const Ray first = begin(wanted);
    const uint32_t taken = wanted & alike(first);
    if (std::popcount(taken) < fewest || (taken & (wanted & -wanted)) == 0) return 0;
    for (size_t r = 0; r < rows; ++r) row[r].repeat(first, part_of(taken, r));
    const auto from = load_axes(first.origin);
    if (!prepare(first, {from, from}, largest_angle, header, pad_scale)) return 0;
    prepare_triangles(first);
    return taken;
  }

  float common_origin[3];

  // The frame of a ray in the middle, in which directions are (slope[0], slope[1], 1) times their dominant component.
  TriangleLanes middle;
  FloatLanes widest[2];  ///< not below any |slope|
  float sign;            ///< of the dominant component: 0 or -0
  struct Frame {
    PacketVector slope[2];
    PacketVector longest;  ///< magnitude of the dominant component
  } frame[rows];

 private:
  using PacketRays::read;
  HWY_INLINE void read(const InInstance& rays) {
    for (size_t r = 0; r < rows; ++r) {
      const PacketRow& from = rays.world.row[r];
      row[r].t_min = from.t_min;
      row[r].t_max = from.t_max;
      std::copy_n(from.origin, 3, row[r].origin);
      std::copy_n(from.direction, 3, row[r].direction);
      if (rays.instance) transform(*rays.instance, row[r]);
    }
  }

  /// object_ray() of rays of one origin.
  static HWY_INLINE void transform(const InstanceRecord& instance, PacketRow& row) {
    const auto& m = instance.world_to_object;
    const DoubleVector3 low = promote_half<0>(row.direction), high = promote_half<1>(row.direction);
    double from[3];
    for (int k = 0; k < 3; ++k) from[k] = double{hn::GetLane(row.origin[k])} - double{instance.object_to_world[k][3]};
    for (int i = 0; i < 3; ++i) {
      row.direction[i] = hn::Combine(PacketFloats(), times_row(m[i], high), times_row(m[i], low));
      row.origin[i] = splat(static_cast<float>((m[i][0] * from[0] + m[i][1] * from[1]) + m[i][2] * from[2]));
    }
  }

  static HWY_INLINE HalfVector times_row(const double* m, const DoubleVector3& v) {
    const PacketDoubles d;
    const auto sum = hn::Add(hn::Mul(hn::Set(d, m[0]), v.x), hn::Mul(hn::Set(d, m[1]), v.y));
    return hn::DemoteTo(HalfFloats(), hn::Add(sum, hn::Mul(hn::Set(d, m[2]), v.z)));
  }

  HWY_INLINE uint32_t alike(const Ray& first) const {
    uint32_t rays = 0;
    for (size_t r = 0; r < rows; ++r)
      rays |= packet_bits(hn::And(PacketRays::alike(r, first, largest_angle / 2), row[r].same_origin(first)))
              << (r * packet_size);
    return rays;
  }

  HWY_INLINE void prepare_triangles(const Ray& first) {
    const Floats d;
    for (uint32_t i = 0; i < 3; ++i) {
      common_origin[i] = first.origin[i];
      middle.axis[i] = axis_after(i);
      middle.origin[i] = hn::Set(d, first.origin[middle.axis[i]]);
    }
    for (size_t r = 0; r < rows; ++r) frame[r].longest = hn::Abs(row[r].direction[dominant_]);
    sign = std::copysign(0.0f, first.direction[dominant_]);
    for (int i = 0; i < 2; ++i) {
      const uint32_t k = middle.axis[i];
      const bool negative = std::signbit(first.direction[k]) != std::signbit(sign);
      const float shear = negative ? -middle_[k] : middle_[k];
      middle.shear[i] = hn::Set(d, shear);
      for (size_t r = 0; r < rows; ++r)
        frame[r].slope[i] = hn::Sub(hn::Div(row[r].direction[k], row[r].direction[dominant_]), splat(shear));
      widest[i] = hn::Set(d, widest_[k]);
    }
  }

  static constexpr int fewest = packet_size / 4;
  static constexpr float largest_angle = 0.25f;
};

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
