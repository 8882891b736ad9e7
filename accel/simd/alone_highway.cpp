// Rays one at a time, apart from the loops for batches. As kernel_highway.cpp.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/accel/simd/alone_highway.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <rayloom/accel/traverse-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel::HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

Hit trace_alone(AddressSpace addresses, const TraceRequest& request) {
  Visitor none;
  return traverse(addresses, request, none);
}

#endif  // HWY_TARGET

}  // namespace rayloom::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
