// Rays that leave one point in nearly the same direction, a lane each, and their box tests. Unlike lanes-inl.h, which
// has no plain twin to agree with here: a packet visits other boxes than a single ray does, and finds the same hits,
// since no box of a hit is missed (docs/numerics.md, "Packets"). Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_RAYS_INL_H_
#undef RAYLOOM_ACCEL_PACKET_RAYS_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_RAYS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/ray_run.h>
#include <rayloom/accel/simd/lanes-inl.h>
#include <rayloom/accel/simd/prepare-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

#if HWY_TARGET == HWY_AVX3
inline constexpr size_t packet_size = 16;
using PacketBits = uint16_t;
#else
inline constexpr size_t packet_size = 8;
using PacketBits = uint8_t;
#endif

using PacketFloats = hn::FixedTag<float, packet_size>;
using PacketWords = hn::FixedTag<uint32_t, packet_size>;
using PacketVector = hn::Vec<PacketFloats>;
using PacketWordVector = hn::Vec<PacketWords>;
using PacketMask = hn::Mask<PacketFloats>;

inline constexpr uint32_t all_rays = PacketBits(~0u);

HWY_INLINE uint32_t packet_bits(PacketMask mask) {
  PacketBits bits = 0;
  hn::StoreMaskBits(PacketFloats(), mask, reinterpret_cast<uint8_t*>(&bits));
  return bits;
}

HWY_INLINE PacketMask packet_mask(uint32_t rays) {
  const auto bits = static_cast<PacketBits>(rays);
  return hn::LoadMaskBits(PacketFloats(), reinterpret_cast<const uint8_t*>(&bits));
}

HWY_INLINE PacketVector splat(float value) { return hn::Set(PacketFloats(), value); }

/// Four floats from `offset` on of the rays first, first + 4, first + 8 ... of a run.
HWY_INLINE PacketVector every_fourth(const RayRun& rays, size_t first, size_t offset) {
  const hn::FixedTag<float, 8> pair;
  const auto four = [&](size_t i) HWY_ATTR { return hn::LoadU(Axes(), rays[first + 4 * i].origin + offset); };
  const auto low = hn::Combine(pair, four(1), four(0));
#if HWY_TARGET == HWY_AVX3
  return hn::Combine(PacketFloats(), hn::Combine(pair, four(3), four(2)), low);
#else
  return low;
#endif
}

/// The four floats from `offset` on of every ray, one vector each.
HWY_INLINE void load_four(const RayRun& rays, size_t offset, PacketVector (&out)[4]) {
  const PacketFloats d;
  const hn::Repartition<double, PacketFloats> wide;
  const PacketVector a = every_fourth(rays, 0, offset), b = every_fourth(rays, 1, offset);
  const PacketVector c = every_fourth(rays, 2, offset), e = every_fourth(rays, 3, offset);
  const auto ab_low = hn::BitCast(wide, hn::InterleaveLower(d, a, b));
  const auto ab_high = hn::BitCast(wide, hn::InterleaveUpper(d, a, b));
  const auto ce_low = hn::BitCast(wide, hn::InterleaveLower(d, c, e));
  const auto ce_high = hn::BitCast(wide, hn::InterleaveUpper(d, c, e));
  out[0] = hn::BitCast(d, hn::InterleaveLower(wide, ab_low, ce_low));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(wide, ab_low, ce_low));
  out[2] = hn::BitCast(d, hn::InterleaveLower(wide, ab_high, ce_high));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(wide, ab_high, ce_high));
}

/// Least and greatest of each axis over the rays; the fourth lane repeats the first.
struct AxisRange {
  hn::Vec<Axes> low, high;
};

struct Least {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};
struct Greatest {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};

template <class Op>
HWY_INLINE hn::Vec<Axes> fold_to_four(PacketVector v, Op op) {
  const hn::FixedTag<float, 8> pair;
#if HWY_TARGET == HWY_AVX3
  const auto eight = op(hn::LowerHalf(pair, v), hn::UpperHalf(pair, v));
#else
  const auto eight = v;
#endif
  return op(hn::LowerHalf(Axes(), eight), hn::UpperHalf(Axes(), eight));
}

template <class Op>
HWY_INLINE hn::Vec<Axes> reduce_axes(const PacketVector (&v)[3], Op op) {
  const Axes d;
  const hn::FixedTag<double, 2> wide;
  const auto x = fold_to_four(v[0], op), y = fold_to_four(v[1], op), z = fold_to_four(v[2], op);
  const auto xy = op(hn::InterleaveLower(d, x, y), hn::InterleaveUpper(d, x, y));  // x y x y
  const auto zx = op(hn::InterleaveLower(d, z, x), hn::InterleaveUpper(d, z, x));
  const auto low = hn::InterleaveLower(wide, hn::BitCast(wide, xy), hn::BitCast(wide, zx));
  const auto high = hn::InterleaveUpper(wide, hn::BitCast(wide, xy), hn::BitCast(wide, zx));
  return op(hn::BitCast(d, low), hn::BitCast(d, high));
}

HWY_INLINE AxisRange range_of(const PacketVector (&v)[3]) {
  return {reduce_axes(v, Least()), reduce_axes(v, Greatest())};
}

/// A packet: some rays of a run of packet_size, and what its tests need beside them. Lanes of other rays repeat
/// the first one's.
class PacketRays {
 public:
  /// Takes on the first of the `wanted` rays and those that go with it; returns them. 0: too few of them do, or they
  /// have extreme coordinates; nothing else may be asked then.
  HWY_INLINE uint32_t load(const RayRun& rays, uint32_t wanted, const StructureHeader& header, float pad_scale) {
    const auto leader = static_cast<uint32_t>(std::countr_zero(wanted));
    const Ray& first = rays[leader];
    load_rays(rays);
    dominant_ = dominant_axis(first.direction);
    const PacketMask together = hn::And(hn::And(moderate(), same_origin(first)), same_octant(first.direction));
    const uint32_t taken = wanted & packet_bits(together);
    if (std::popcount(taken) < fewest || (taken >> leader & 1) == 0) return 0;
    if (taken != all_rays) repeat(first, packet_mask(taken));
    if (!find_angles() || !prepare_boxes(first, header, pad_scale)) return 0;
    prepare_triangles(first);
    return taken;
  }

  /// t in box space, rounded outward: PreparedRay::near_limit() and far_limit().
  HWY_INLINE PacketVector near_limit() const {
    const PacketVector scaled = hn::Mul(t_min, splat(box_scale_));
    return hn::IfThenElseZero(hn::Ge(scaled, splat(0x1p-126f)), hn::Min(scaled, splat(0x1p120f)));
  }
  HWY_INLINE PacketVector far_limit(PacketVector t) const {
    return hn::Max(hn::Mul(t, splat(box_scale_)), splat(0x1p-126f));
  }

  PacketVector direction[3], t_min, t_max;
  float origin[3];

  // Triangles: the frame of a ray in the middle, in which directions are (slope[0], slope[1], 1) times their dominant
  // component.
  TriangleLanes middle;
  PacketVector slope[2];
  FloatLanes widest[2];  ///< not below any |slope|
  PacketVector longest;  ///< magnitude of the dominant component
  float sign;            ///< of that component: 0 or -0
  float depth_scale;     ///< takes t in box space to a depth that is not below t |dominant component|

  // Boxes: as in PreparedRay.
  PacketVector reciprocal[3], near_offset[3], far_offset[3];
  uint32_t near_row[4];

  // Boxes, for all rays at once: planes are taken relative to the origin, moved outward, and times either end of the
  // widened range of reciprocals.
  FloatLanes near_corner[3], far_corner[3], least[3], most[3];

 private:
  HWY_INLINE void load_rays(const RayRun& rays) {
    PacketVector four[4];
    load_four(rays, 0, four);
    for (int k = 0; k < 3; ++k) origin_[k] = four[k];
    t_min = four[3];
    load_four(rays, 4, four);
    for (int k = 0; k < 3; ++k) direction[k] = four[k];
    t_max = four[3];
  }

  /// traceable(), of directions that are neither long nor short. The origin is looked at elsewhere.
  HWY_INLINE PacketMask moderate() const {
    PacketMask good = hn::And(hn::Ge(t_min, splat(0)), hn::Le(t_min, t_max));
    const PacketVector dominant = hn::Abs(direction[dominant_]);
    good = hn::And(good, hn::Ge(dominant, splat(shortest_direction)));
    good = hn::And(good, hn::Le(dominant, splat(longest_direction)));
    for (const PacketVector& component : direction) good = hn::And(good, hn::Le(hn::Abs(component), dominant));
    return good;
  }

  HWY_INLINE PacketMask same_origin(const Ray& first) const {
    const auto at = [&](int k) { return hn::Eq(origin_[k], splat(first.origin[k])); };
    return hn::And(at(0), hn::And(at(1), at(2)));
  }

  HWY_INLINE PacketMask same_octant(const float* first) const {
    const hn::RebindToSigned<PacketFloats> w;
    PacketVector differences = hn::Xor(direction[0], splat(first[0]));
    for (int k = 1; k < 3; ++k) differences = hn::Or(differences, hn::Xor(direction[k], splat(first[k])));
    return hn::Not(hn::RebindMask(PacketFloats(), hn::Lt(hn::BitCast(w, differences), hn::Zero(w))));
  }

  HWY_INLINE void repeat(const Ray& first, PacketMask taken) {
    for (int k = 0; k < 3; ++k) direction[k] = hn::IfThenElse(taken, direction[k], splat(first.direction[k]));
    t_min = hn::IfThenElse(taken, t_min, splat(first.t_min));
    t_max = hn::IfThenElse(taken, t_max, splat(first.t_max));
  }

  static uint32_t dominant_axis(const float* direction) {
    const float x = std::fabs(direction[0]), y = std::fabs(direction[1]), z = std::fabs(direction[2]);
    const uint32_t first = y > x;
    return z > std::max(x, y) ? 2 : first;
  }

  /// Whether directions lie within a small angle; differences of their lengths are counted as angles.
  HWY_INLINE bool find_angles() {
    const Axes d;
    const PacketVector magnitude[3] = {hn::Abs(direction[0]), hn::Abs(direction[1]), hn::Abs(direction[2])};
    magnitudes_ = range_of(magnitude);
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

  HWY_INLINE bool prepare_boxes(const Ray& first, const StructureHeader& header, float pad_scale) {
    const Axes d;
    const auto low = load_axes(header.bounds_min), high = load_axes(header.bounds_max);
    const auto from = load_axes(first.origin);
    const auto coordinates = hn::Max(hn::Abs(from), hn::Max(hn::Abs(low), hn::Abs(high)));
    const float largest = hn::GetLane(hn::MaxOfLanes(d, coordinates));
    if (!(largest >= smallest_scene && largest <= largest_scene)) return false;
    const auto reach = hn::Max(hn::Abs(hn::Sub(high, from)), hn::Abs(hn::Sub(low, from)));
    const float farthest = pad_scale > 1 ? largest_lane(reach) : 0;
    const BoxScale scale = box_scale_of(least_dominant_, largest, farthest, pad_scale);
    if (!(scale.common_pad <= 0x1p-10f * largest)) return false;
    const auto direction_scale = static_cast<float>(scale.direction);
    box_scale_ = static_cast<float>(scale.time);
    depth_scale = most_dominant_ * direction_scale * (1 + 0x1p-18f);
    const auto sizes = hn::Mul(hn::Add(reach, hn::Abs(from)), hn::Set(d, 0x1p-22f));
    const auto pad = hn::Mul(hn::Add(sizes, hn::Set(d, 2 * scale.common_pad)), hn::Set(d, 1 + 0x1p-20f));
    prepare_each(first, pad, direction_scale, scale.shortest);
    prepare_all(first, pad, direction_scale, scale.shortest);
    return true;
  }

  HWY_INLINE void prepare_each(const Ray& first, hn::Vec<Axes> pads, float scale, float shortest) {
    alignas(16) float pad[4];
    hn::Store(pads, Axes(), pad);
    for (int k = 0; k < 3; ++k) {
      const PacketVector component = hn::Abs(hn::Mul(direction[k], splat(scale)));
      const PacketVector magnitude = hn::Div(splat(1), hn::Max(component, splat(shortest)));
      reciprocal[k] = hn::CopySign(magnitude, direction[k]);
      const PacketVector centre = hn::Mul(splat(-first.origin[k]), reciprocal[k]);
      near_offset[k] = hn::NegMulAdd(splat(pad[k]), magnitude, centre);
      far_offset[k] = hn::MulAdd(splat(pad[k]), magnitude, centre);
    }
  }

  HWY_INLINE void prepare_all(const Ray& first, hn::Vec<Axes> pad, float scale, float shortest) {
    const Axes d;
    const AxisWords u;
    const hn::RebindToSigned<Axes> i;
    const auto signs = load_axes(first.direction), from = load_axes(first.origin);
    const auto backward = hn::RebindMask(d, hn::Lt(hn::BitCast(i, signs), hn::Zero(i)));
    const auto one = hn::Set(d, 1), clamp = hn::Set(d, shortest);
    const auto smallest = hn::Div(one, hn::Max(hn::Mul(magnitudes_.high, hn::Set(d, scale)), clamp));
    const auto greatest = hn::Div(one, hn::Max(hn::Mul(magnitudes_.low, hn::Set(d, scale)), clamp));
    const auto below = hn::Sub(from, hn::Add(pad, pad)), above = hn::Add(from, hn::Add(pad, pad));
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

  HWY_INLINE void prepare_triangles(const Ray& first) {
    constexpr uint32_t following[] = {0, 1, 2, 0, 1};
    const Floats d;
    for (uint32_t i = 0; i < 3; ++i) {
      origin[i] = first.origin[i];
      middle.axis[i] = following[dominant_ + (i + 1) % 3];
      middle.origin[i] = hn::Set(d, first.origin[middle.axis[i]]);
    }
    longest = hn::Abs(direction[dominant_]);
    sign = std::copysign(0.0f, first.direction[dominant_]);
    for (int i = 0; i < 2; ++i) {
      const uint32_t k = middle.axis[i];
      const bool negative = std::signbit(first.direction[k]) != std::signbit(sign);
      const float shear = negative ? -middle_[k] : middle_[k];
      middle.shear[i] = hn::Set(d, shear);
      slope[i] = hn::Sub(hn::Div(direction[k], direction[dominant_]), splat(shear));
      widest[i] = hn::Set(d, widest_[k]);
    }
  }

  static constexpr int fewest = packet_size / 4;
  static constexpr float longest_direction = 0x1p60f, shortest_direction = 0x1p-60f, largest_angle = 0x1p-3f;
  static constexpr float smallest_scene = 0x1p-60f, largest_scene = 0x1p38f;

  uint32_t dominant_;
  float least_dominant_, most_dominant_;
  float box_scale_;
  alignas(16) float middle_[4], widest_[4];  ///< of |components| over the dominant one, by axis
  AxisRange magnitudes_;
  PacketVector origin_[3];
};

/// Entries of eight boxes, and which of them any of the rays may meet in [t_near, t_far].
struct PacketBoxHits {
  FloatLanes entry;
  uint32_t mask;
};

HWY_INLINE PacketBoxHits test_boxes(const PacketRays& rays, const Node8& node, FloatLanes t_near, FloatLanes t_far) {
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

/// The rays that meet one child's box: test_node() for one box and many rays.
HWY_INLINE uint32_t test_child(const PacketRays& rays, const Node8& node, int lane, PacketVector t_near,
                               PacketVector t_far) {
  const float* const planes = &node.bounds[0][0][lane];
  PacketVector entry[3], exit[3];
  for (int k = 0; k < 3; ++k) {
    entry[k] = hn::MulAdd(splat(planes[rays.near_row[k]]), rays.reciprocal[k], rays.near_offset[k]);
    exit[k] = hn::MulAdd(splat(planes[rays.near_row[k] ^ 8]), rays.reciprocal[k], rays.far_offset[k]);
  }
  return packet_bits(hn::Le(hn::Max(hn::Max(entry[0], entry[1]), hn::Max(entry[2], t_near)),
                            hn::Min(hn::Min(exit[0], exit[1]), hn::Min(exit[2], t_far))));
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
