// The bits of a vector mask as a number, re-included once per target by Highway's foreach_target.h.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_MASK_BITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_MASK_BITS_INL_H_
#undef RAYLOOM_ACCEL_MASK_BITS_INL_H_
#else
#define RAYLOOM_ACCEL_MASK_BITS_INL_H_
#endif
// clang-format on

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace hn = hwy::HWY_NAMESPACE;

/// Bit i for lane i, of at most sixteen. Of a mask register through assembly: where GCC 12 runs short of registers it
/// stores the eight bits of StoreMaskBits() on the stack and reads 32 from there.
template <class D, class M>
HWY_INLINE uint32_t bits_of(D d, M mask) {
#if HWY_TARGET == HWY_AVX3
  constexpr size_t lanes = hn::MaxLanes(D());
  uint32_t bits;
  if constexpr (lanes == 16)
    asm("kmovw %1, %0" : "=r"(bits) : "k"(mask.raw));
  else
    asm("kmovb %1, %0" : "=r"(bits) : "k"(mask.raw));
  return lanes < 8 ? bits & ((1u << lanes) - 1) : bits;
#else
  uint8_t bits = 0;
  hn::StoreMaskBits(d, mask, &bits);
  return bits;
#endif
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
