// Rays of nearly the same direction, a lane each, made ready for box tests. Re-included once per target as lanes-inl.h
// is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_RAYS_INL_H_
#undef RAYLOOM_ACCEL_PACKET_RAYS_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_RAYS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_boxes-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// A packet: some rays of a group of up to `size`, and what box tests need beside them. Bit i of a mask is ray i of the
/// group, which is lane i % packet_size of row i / packet_size.
template <size_t row_count>
class PacketRays : public SharedBoxes {
 public:
  static constexpr size_t rows = row_count, size = rows * packet_size;
  static constexpr uint32_t everyone = ~0u >> (32 - size);
  /// The bits of one row.
  static HWY_INLINE uint32_t part_of(uint32_t rays, size_t r) { return rays >> (r * packet_size) & all_rays; }

  /// t in box space, rounded outward: PreparedRay::near_limit() and far_limit().
  HWY_INLINE PacketVector near_limit(size_t r) const {
    const PacketVector scaled = hn::Mul(row[r].t_min, splat(box_scale_));
    return hn::IfThenElseZero(hn::Ge(scaled, splat(0x1p-126f)), hn::Min(scaled, splat(0x1p120f)));
  }
  HWY_INLINE PacketVector far_limit(PacketVector t) const {
    return hn::Max(hn::Mul(t, splat(box_scale_)), splat(0x1p-126f));
  }

  /// Ray i of the group, if it has been taken on.
  HWY_INLINE Ray ray(uint32_t i) const { return row[i / packet_size].ray(i % packet_size); }

  PacketRow row[rows];
  float depth_scale;  ///< takes t in box space to a depth that is not below t |dominant component|

 protected:
  HWY_INLINE void read(const RayRun& group) {
    for (size_t r = 0; r < rows; ++r) row[r].load(group, r * packet_size);
  }
  /// Of rays that have been read: the first of the `wanted` ones, with which others may go.
  HWY_INLINE Ray begin(uint32_t wanted) {
    const Ray first = ray(static_cast<uint32_t>(std::countr_zero(wanted)));
    dominant_ = dominant_axis(first.direction);
    return first;
  }

  /// Rays of a row whose directions are near the first one's, and neither long nor short. `difference`: of components,
  /// over the first one's dominant one.
  HWY_INLINE PacketMask alike(size_t r, const Ray& first, float difference) const {
    const PacketMask near = row[r].within(first, difference * std::fabs(first.direction[dominant_]));
    return hn::And(near, hn::And(row[r].moderate(dominant_), row[r].same_octant(first.direction)));
  }

  /// Makes the box tests ready. `from`: of the origins. False: angles are too large, or coordinates are extreme.
  HWY_INLINE bool prepare(const Ray& first, const AxisRange& from, float largest_angle, const StructureHeader& header,
                          float pad_scale) {
    return find_angles(largest_angle) && prepare_boxes(first, from, header, pad_scale);
  }

  /// PreparedRay::axis
  HWY_INLINE uint32_t axis_after(uint32_t i) const {
    constexpr uint32_t following[] = {0, 1, 2, 0, 1};
    return following[dominant_ + (i + 1) % 3];
  }

  uint32_t dominant_;
  alignas(16) float middle_[4], widest_[4];  ///< of |components| over the dominant one, by axis

 private:
  static uint32_t dominant_axis(const float* direction) {
    const float x = std::fabs(direction[0]), y = std::fabs(direction[1]), z = std::fabs(direction[2]);
    const uint32_t first = y > x;
    return z > std::max(x, y) ? 2 : first;
  }

  /// Of |components| of directions.
  HWY_INLINE AxisRange magnitudes() const {
    PacketVector low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = high[k] = hn::Abs(row[0].direction[k]);
      for (size_t r = 1; r < rows; ++r) {
        low[k] = hn::Min(low[k], hn::Abs(row[r].direction[k]));
        high[k] = hn::Max(high[k], hn::Abs(row[r].direction[k]));
      }
    }
    return {reduce_axes(low, Least()), reduce_axes(high, Greatest())};
  }

  /// Whether directions lie within a small angle; differences of their lengths are counted as angles.
  HWY_INLINE bool find_angles(float largest_angle) {
    const Axes d;
    magnitudes_ = magnitudes();
    alignas(16) float low[4], high[4];
    hn::Store(magnitudes_.low, d, low);
    hn::Store(magnitudes_.high, d, high);
    least_dominant_ = low[dominant_];
    most_dominant_ = high[dominant_];
    const auto gentle = hn::Div(magnitudes_.low, hn::Set(d, most_dominant_));
    const auto steep = hn::Div(magnitudes_.high, hn::Set(d, least_dominant_));
    hn::Store(hn::Mul(hn::Add(steep, gentle), hn::Set(d, 0.5f)), d, middle_);
    hn::Store(hn::MulAdd(hn::Sub(steep, gentle), hn::Set(d, 0.5f + 0x1p-11f), hn::Set(d, 0x1p-20f)), d, widest_);
    const auto narrow = hn::Le(hn::Sub(steep, gentle), hn::Set(d, largest_angle));
    return hn::AllTrue(d, narrow);
  }

  HWY_INLINE bool prepare_boxes(const Ray& first, const AxisRange& from, const StructureHeader& header,
                                float pad_scale) {
    const Axes d;
    const auto low = load_axes(header.bounds_min), high = load_axes(header.bounds_max);
    const auto far_from = hn::Max(hn::Abs(from.low), hn::Abs(from.high));
    const float largest = largest_lane(hn::Max(far_from, hn::Max(hn::Abs(low), hn::Abs(high))));
    if (!(largest >= smallest_scene && largest <= largest_scene)) return false;
    const auto reach = hn::Max(reach_of(from.low, low, high), reach_of(from.high, low, high));
    const float farthest = pad_scale > 1 ? largest_lane(reach) : 0;
    const BoxScale scale = box_scale_of(least_dominant_, largest, farthest, pad_scale);
    if (!(scale.common_pad <= 0x1p-10f * largest)) return false;
    const auto direction_scale = static_cast<float>(scale.direction);
    box_scale_ = static_cast<float>(scale.time);
    depth_scale = most_dominant_ * direction_scale * (1 + 0x1p-18f);
    const auto sizes = hn::Mul(hn::Add(reach, far_from), hn::Set(d, 0x1p-22f));
    const auto pad = hn::Mul(hn::Add(sizes, hn::Set(d, 2 * scale.common_pad)), hn::Set(d, 1 + 0x1p-20f));
    alignas(16) float pads[4];
    hn::Store(pad, d, pads);
    for (PacketRow& each : row) each.prepare_boxes(pads, direction_scale, scale.shortest);
    prepare_all(first, from, pad, direction_scale, scale.shortest);
    return true;
  }

  static HWY_INLINE hn::Vec<Axes> reach_of(hn::Vec<Axes> from, hn::Vec<Axes> low, hn::Vec<Axes> high) {
    return hn::Max(hn::Abs(hn::Sub(high, from)), hn::Abs(hn::Sub(low, from)));
  }

  HWY_INLINE void prepare_all(const Ray& first, const AxisRange& from, hn::Vec<Axes> pad, float scale, float shortest) {
    const Axes d;
    const AxisWords u;
    const hn::RebindToSigned<Axes> i;
    const auto signs = load_axes(first.direction);
    const auto backward = hn::RebindMask(d, hn::Lt(hn::BitCast(i, signs), hn::Zero(i)));
    const auto one = hn::Set(d, 1), clamp = hn::Set(d, shortest);
    const auto smallest = hn::Div(one, hn::Max(hn::Mul(magnitudes_.high, hn::Set(d, scale)), clamp));
    const auto greatest = hn::Div(one, hn::Max(hn::Mul(magnitudes_.low, hn::Set(d, scale)), clamp));
    const auto below = hn::Sub(from.low, hn::Add(pad, pad)), above = hn::Add(from.high, hn::Add(pad, pad));
    alignas(16) float values[4][4];
    hn::Store(hn::CopySign(hn::Mul(smallest, hn::Set(d, 1 - 0x1p-22f)), signs), d, values[0]);
    hn::Store(hn::CopySign(hn::Mul(greatest, hn::Set(d, 1 + 0x1p-22f)), signs), d, values[1]);
    hn::Store(hn::IfThenElse(backward, below, above), d, values[2]);
    hn::Store(hn::IfThenElse(backward, above, below), d, values[3]);
    const Floats lanes;
    for (int k = 0; k < 3; ++k) {
      least[k] = hn::Set(lanes, values[0][k]);
      most[k] = hn::Set(lanes, values[1][k]);
      near_corner[k] = hn::Set(lanes, values[2][k]);
      far_corner[k] = hn::Set(lanes, values[3][k]);
    }
    alignas(16) static constexpr uint32_t rows[] = {0, 16, 32, 0};
    hn::Store(hn::Add(hn::Load(u, rows), hn::ShiftLeft<3>(hn::ShiftRight<31>(hn::BitCast(u, signs)))), u, near_row);
  }

  static constexpr float smallest_scene = 0x1p-60f, largest_scene = 0x1p38f;

  float least_dominant_, most_dominant_;
  float box_scale_;
  AxisRange magnitudes_;
};

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
