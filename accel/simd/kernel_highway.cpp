// The kernels for AVX2 with FMA and for AVX-512, compiled from one source by Highway's foreach_target.h.

// Highway's other targets are off; it always adds the build's baseline, for which traverse-inl.h leaves nothing.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/accel/simd/kernel_highway.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <rayloom/accel/batch-inl.h>
#include <rayloom/accel/simd/kernel.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

void trace_rays(AddressSpace addresses, const RayRun& rays, Hit* hits) { trace_run(addresses, rays, hits); }

void occlude_rays(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  occlude_run(addresses, rays, results);
}

void trace_many(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits) {
  trace_batch(addresses, requests, hits);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloom::accel {
namespace {
constexpr Kernel avx2_kernel{N_AVX2::trace_alone, N_AVX2::trace_rays, N_AVX2::occlude_rays, N_AVX2::trace_many};
constexpr Kernel avx512_kernel{N_AVX3::trace_alone, N_AVX3::trace_rays, N_AVX3::occlude_rays, N_AVX3::trace_many};
}  // namespace

const Kernel* highway_kernel(Isa isa) {
  const int64_t supported = hwy::SupportedTargets();
  if (isa == Isa::avx2 && (supported & HWY_AVX2)) return &avx2_kernel;
  if (isa == Isa::avx512 && (supported & HWY_AVX3)) return &avx512_kernel;
  return nullptr;
}

}  // namespace rayloom::accel
#endif  // HWY_ONCE
