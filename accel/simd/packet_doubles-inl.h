// Vectors of a double for each ray of half a row. Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_DOUBLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_DOUBLES_INL_H_
#undef RAYLOOM_ACCEL_PACKET_DOUBLES_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_DOUBLES_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_vectors-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// Half a row of rays in doubles.
using PacketDoubles = hn::FixedTag<double, packet_size / 2>;
using HalfFloats = hn::FixedTag<float, packet_size / 2>;
using DoubleVector = hn::Vec<PacketDoubles>;
using HalfVector = hn::Vec<HalfFloats>;

struct DoubleVector3 {
  DoubleVector x, y, z;
};

HWY_INLINE DoubleVector3 subtract(const DoubleVector3& a, const DoubleVector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE DoubleVector dot(const DoubleVector3& a, const DoubleVector3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE DoubleVector3 cross(const DoubleVector3& a, const DoubleVector3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE DoubleVector absolute_sum(const DoubleVector3& a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
HWY_INLINE DoubleVector3 splat(const float (&p)[3]) {
  const PacketDoubles d;
  return {hn::Set(d, double{p[0]}), hn::Set(d, double{p[1]}), hn::Set(d, double{p[2]})};
}

template <int half>
HWY_INLINE DoubleVector promote_half(PacketVector v) {
  const HalfFloats narrow;
  if constexpr (half == 0)
    return hn::PromoteTo(PacketDoubles(), hn::LowerHalf(narrow, v));
  else
    return hn::PromoteTo(PacketDoubles(), hn::UpperHalf(narrow, v));
}

template <int half>
HWY_INLINE DoubleVector3 promote_half(const PacketVector (&v)[3]) {
  return {promote_half<half>(v[0]), promote_half<half>(v[1]), promote_half<half>(v[2])};
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
