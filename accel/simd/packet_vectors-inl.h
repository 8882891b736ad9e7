// Vectors of a float for each ray of a packet, and how they are filled from rays. Re-included once per target as
// lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_VECTORS_INL_H_
#undef RAYLOOM_ACCEL_PACKET_VECTORS_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_VECTORS_INL_H_
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

HWY_INLINE uint32_t packet_bits(PacketMask mask) { return bits_of(PacketFloats(), mask); }

HWY_INLINE PacketMask packet_mask(uint32_t rays) {
  const auto bits = static_cast<PacketBits>(rays);
  return hn::LoadMaskBits(PacketFloats(), reinterpret_cast<const uint8_t*>(&bits));
}

HWY_INLINE PacketVector splat(float value) { return hn::Set(PacketFloats(), value); }

/// Four floats from `offset` on of the rays begin, begin + 4, begin + 8 ... of a group; past its end, of its last ray.
HWY_INLINE PacketVector every_fourth(const RayRun& group, size_t begin, size_t offset) {
  const hn::FixedTag<float, 8> pair;
  const auto four = [&](size_t i) HWY_ATTR {
    const size_t ray = std::min(begin + 4 * i, group.count - 1);
    return hn::LoadU(Axes(), reinterpret_cast<const float*>(&group[ray]) + offset);
  };
  const auto low = hn::Combine(pair, four(1), four(0));
#if HWY_TARGET == HWY_AVX3
  return hn::Combine(PacketFloats(), hn::Combine(pair, four(3), four(2)), low);
#else
  return low;
#endif
}

/// The four floats from `offset` on of packet_size rays, one vector each.
HWY_INLINE void load_four(const RayRun& group, size_t begin, size_t offset, PacketVector (&out)[4]) {
  const PacketFloats d;
  const hn::Repartition<double, PacketFloats> wide;
  const PacketVector a = every_fourth(group, begin, offset), b = every_fourth(group, begin + 1, offset);
  const PacketVector c = every_fourth(group, begin + 2, offset), e = every_fourth(group, begin + 3, offset);
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

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
