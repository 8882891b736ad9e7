// What builders do in vectors, for AVX2 and for AVX-512, compiled from one source by Highway's foreach_target.h.

// Highway's other targets are off; it always adds the build's baseline, for which nothing is left.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/accel/simd/build_highway.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <rayloom/accel/simd/collapse_plan-inl.h>
#include <rayloom/accel/simd/leaf_table-inl.h>
#include <rayloom/accel/simd/triangle_keys-inl.h>
#include <rayloom/accel/simd/triangle_refs-inl.h>
#include <rayloom/accel/trace.h>

#if HWY_ONCE
namespace rayloom::accel {
namespace {
constexpr BuildKernel avx2_kernel{N_AVX2::make_keys,        N_AVX2::vertex_bounds,      N_AVX2::gather_refs,
                                  N_AVX2::write_table_leaf, N_AVX2::write_leaf_of_rows, N_AVX2::plan_collapse};
constexpr BuildKernel avx512_kernel{N_AVX3::make_keys,        N_AVX3::vertex_bounds,      N_AVX3::gather_refs,
                                    N_AVX3::write_table_leaf, N_AVX3::write_leaf_of_rows, N_AVX3::plan_collapse};
}  // namespace

const BuildKernel* build_kernel() {
  switch (current_isa()) {
    case Isa::avx512:
      return &avx512_kernel;
    case Isa::avx2:
      return &avx2_kernel;
    case Isa::scalar:
      break;
  }
  return nullptr;
}

}  // namespace rayloom::accel
#endif  // HWY_ONCE
