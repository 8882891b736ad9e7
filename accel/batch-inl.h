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

#include <rayloom/accel/rays_apart-inl.h>
#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/packet_instances-inl.h>
#include <rayloom/accel/packet_occlusion-inl.h>
#include <rayloom/accel/packets_in_turn-inl.h>
#endif

#ifdef HWY_TARGET_INCLUDE
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

inline bool any_hit(const TraceRequest& request) {
  return (request.ray_flags & ray_flag::accept_first_hit_and_end_search) != 0;
}

/// Whether rays may find anything at all in the structure.
inline bool worth_entering(const TraceRequest& request) {
  if (!request.structure) return false;
  const StructureHeader& header = header_of(request.structure);
  if (header.kind == StructureKind::instances) return header.root != no_index;
  return wants(request, header);
}

#ifdef HWY_TARGET_INCLUDE
/// Rays that go together as packets, the others apart. Packet: see PacketsInTurn. Returns the number of rays traced in
/// packets.
template <class Packet>
size_t trace_in_turn(AddressSpace addresses, const RayRun& rays, typename Packet::Result* results) {
  RaysApart<typename Packet::Result> apart(addresses, rays, results);
  PacketsInTurn<Packet>(addresses, rays, results).run([&](size_t begin, size_t count) { apart.add(begin, count); });
  apart.finish();
  return rays.count - apart.count();
}

/// Closest hits of rays, at least packet_size of them.
inline size_t trace_in_packets(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  if (header_of(rays.shared->structure).kind == StructureKind::instances)
    return trace_in_turn<InstancePacket>(addresses, rays, hits);
  return trace_in_turn<TrianglePacket>(addresses, rays, hits);
}

/// Whether two rays may go together in a bundle, without looking at where they begin.
inline bool alike(const Ray& a, const Ray& b) {
  float longest = 0, difference = 0;
  for (int k = 0; k < 3; ++k) {
    longest = std::max(longest, std::fabs(a.direction[k]));
    difference = std::max(difference, std::fabs(a.direction[k] - b.direction[k]));
  }
  return difference <= longest * BundleRays::largest_difference;
}

/// Of a few pairs of neighbours, whether most are alike. Rays of which this is false are not worth a closer look.
inline bool look_alike(const RayRun& rays) {
  constexpr size_t pairs = 4;
  size_t count = 0;
  for (size_t i = 0; i < pairs; ++i) count += alike(rays[i * rays.count / pairs], rays[i * rays.count / pairs + 1]);
  return count > pairs / 2;
}

/// Whether rays hit anything in a structure of triangles.
inline size_t occlude_in_packets(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  return trace_in_turn<OcclusionPacket>(addresses, rays, results);
}

/// The same through instances: first at what occluded rays before, as long as that is worth it.
inline void occlude_by_recent(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  Interleaver<Order::stored, true, uint8_t, false, true> first(addresses, rays, results);
  first.run();
  const size_t done = first.traced();
  if (done != rays.count) trace_apart(addresses, rays.part(done, rays.count - done), results + done);
}

/// Whether to go one of these ways.
inline bool look_alike_enough(const RayRun& rays, bool flat) {
  constexpr size_t few = 256;  // hints come from rays that are done
  return rays.count >= (flat ? packet_size : few) && look_alike(rays);
}
#endif

inline void trace_closest(AddressSpace addresses, const RayRun& rays, Hit* hits) {
#ifdef HWY_TARGET_INCLUDE
  if (rays.count >= packet_size) {
    trace_in_packets(addresses, rays, hits);
    return;
  }
#endif
  trace_apart(addresses, rays, hits);
}

/// Rays that find nothing in an ordinary structure: it is lazy, or empty, or not wanted.
[[gnu::noinline]] inline void trace_unentered(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  if (rays.shared->structure && is_lazy(header_of(rays.shared->structure)))
    trace_lazily(addresses, rays, hits);
  else
    trace_one_by_one(addresses, rays, hits);
}

/// A request without its candidate function.
inline TraceRequest without_candidate(TraceRequest request) {
  request.candidate = nullptr;
  return request;
}

inline void trace_run(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  constexpr size_t worth_interleaving = 4;
  if (rays.shared->candidate && never_asks(*rays.shared)) {
    const TraceRequest shared = without_candidate(*rays.shared);
    return trace_run(addresses, {&shared, rays.first, rays.stride, rays.count}, hits);
  }
  if (rays.shared->candidate || rays.count < worth_interleaving)
    trace_one_by_one(addresses, rays, hits);
  else if (!worth_entering(*rays.shared))
    trace_unentered(addresses, rays, hits);
  else if (any_hit(*rays.shared))
    interleave<Order::stored>(addresses, rays, hits);
  else
    trace_closest(addresses, rays, hits);
}

/// results[i]: whether ray i hits anything.
inline void occlude_run(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  if (rays.shared->candidate && never_asks(*rays.shared)) {
    const TraceRequest shared = without_candidate(*rays.shared);
    return occlude_run(addresses, {&shared, rays.first, rays.stride, rays.count}, results);
  }
  if (!rays.shared->candidate && worth_entering(*rays.shared)) {
#ifdef HWY_TARGET_INCLUDE
    const bool flat = header_of(rays.shared->structure).kind == StructureKind::triangles;
    if (look_alike_enough(rays, flat)) {
      flat ? void(occlude_in_packets(addresses, rays, results)) : occlude_by_recent(addresses, rays, results);
      return;
    }
#endif
    return trace_apart(addresses, rays, results);
  }
  if (!rays.shared->candidate && rays.shared->structure && is_lazy(header_of(rays.shared->structure)))
    return occlude_lazily(addresses, rays, results);
  TraceRequest request = *rays.shared;
  for (size_t i = 0; i < rays.count; ++i) {
    request.ray = rays[i];
    results[i] = static_cast<bool>(trace_alone(addresses, request));
  }
}

inline void trace_batch(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits) {
  /// Requests are looked at twice; a run of this many is still in the cache the second time.
  constexpr size_t longest_run = 2048;
  for (size_t begin = 0; begin < requests.size();) {
    size_t end = begin + 1;
    const bool silent = never_asks(requests[begin]);
    const bool goes_alone = requests[begin].candidate && !silent;
    const size_t last = goes_alone ? end : std::min(requests.size(), begin + longest_run);
    while (end < last && same_run(requests[begin], requests[end], silent)) ++end;
    trace_run(addresses, run_of(requests.subspan(begin, end - begin)), &hits[begin]);
    begin = end;
  }
}

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
