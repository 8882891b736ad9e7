// As kernel_highway.cpp.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/accel/simd/lazy_highway.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <rayloom/accel/lazy-inl.h>
