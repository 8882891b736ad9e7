// Many requests: each run of requests that can be traced together goes to the loop that suits it. Re-included once per
// target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_BATCH_INL_H
#undef RAYLOOM_ACCEL_BATCH_INL_H
#else
#define RAYLOOM_ACCEL_BATCH_INL_H
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

inline Hit trace_alone(AddressSpace addresses, const TraceRequest& request) {
  Visitor none;
  return traverse(addresses, request, none);
}

/// What requests of one run have in common.
struct BatchKind {
  bool asks;  ///< has a candidate function, whose calls come ray by ray
  bool any_hit;
  bool instances;
  bool operator==(const BatchKind&) const = default;
};

inline BatchKind kind_of(const TraceRequest& request) {
  return {request.candidate != nullptr, (request.ray_flags & ray_flag::accept_first_hit_and_end_search) != 0,
          request.structure && header_of(request.structure).kind == StructureKind::instances};
}

template <Order order>
void interleave(AddressSpace addresses, std::span<const TraceRequest> requests, Hit* hits, bool instances) {
  if (instances)
    Interleaver<order, true>(addresses, requests, hits).run();
  else
    Interleaver<order, false>(addresses, requests, hits).run();
}

inline void trace_run(AddressSpace addresses, std::span<const TraceRequest> requests, Hit* hits, BatchKind kind) {
  constexpr size_t worth_interleaving = 4;
  if (kind.asks || requests.size() < worth_interleaving) {
    for (size_t i = 0; i < requests.size(); ++i) hits[i] = trace_alone(addresses, requests[i]);
  } else if (kind.any_hit) {
    interleave<Order::stored>(addresses, requests, hits, kind.instances);
  } else {
    interleave<Order::distance>(addresses, requests, hits, kind.instances);
  }
}

/// Requests are looked at twice; a run of this many is still in the cache the second time.
inline constexpr size_t longest_run = 2048;

inline void trace_batch(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits) {
  for (size_t begin = 0, end = 0; begin < requests.size(); begin = end) {
    const BatchKind kind = kind_of(requests[begin]);
    const size_t last = std::min(requests.size(), begin + longest_run);
    while (end < last && kind_of(requests[end]) == kind) ++end;
    trace_run(addresses, requests.subspan(begin, end - begin), &hits[begin], kind);
  }
}

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
