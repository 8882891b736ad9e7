// Rays through lazy structures: the loops for ordinary ones, which build a part of a structure where a ray comes to it
// and go on in it. Re-included once per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_LAZY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_LAZY_INL_H
#undef RAYLOOM_ACCEL_LAZY_INL_H
#else
#define RAYLOOM_ACCEL_LAZY_INL_H
#endif
// clang-format on

#include <rayloom/accel/interleave-inl.h>

#ifdef HWY_TARGET_INCLUDE
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

template <Order order, class Result>
void interleave_lazily(AddressSpace addresses, const RayRun& rays, Result* results) {
  if (header_of(rays.shared->structure).kind == StructureKind::instances)
    Interleaver<order, true, Result, true>(addresses, rays, results).run();
  else
    Interleaver<order, false, Result, true>(addresses, rays, results).run();
}

Hit trace_lazily(AddressSpace addresses, const TraceRequest& request) {
  Visitor none;
  return traverse<true>(addresses, request, none);
}

/// Whether a bottom level has nothing that the rays want.
inline bool is_skipped(const TraceRequest& request) {
  const StructureHeader& header = header_of(request.structure);
  return header.kind == StructureKind::triangles && !wants<true>(request, header);
}

/// Rays without candidate function.
void trace_lazily(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  if (is_skipped(*rays.shared)) {
    for (size_t i = 0; i < rays.count; ++i) hits[i] = Hit{.t = rays[i].t_max};
  } else if (rays.shared->ray_flags & ray_flag::accept_first_hit_and_end_search) {
    interleave_lazily<Order::stored>(addresses, rays, hits);
  } else {
    interleave_lazily<Order::distance>(addresses, rays, hits);
  }
}

void occlude_lazily(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  if (is_skipped(*rays.shared))
    std::fill_n(results, rays.count, uint8_t{0});
  else
    interleave_lazily<Order::stored>(addresses, rays, results);
}

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
