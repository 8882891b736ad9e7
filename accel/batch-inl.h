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
#include <rayloom/accel/ray_run.h>
#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/packet_instances-inl.h>
#endif

#include <vector>

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

inline void trace_one_by_one(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  TraceRequest request = *rays.shared;
  for (size_t i = 0; i < rays.count; ++i) {
    request.ray = rays[i];
    hits[i] = trace_alone(addresses, request);
  }
}

inline bool any_hit(const TraceRequest& request) {
  return (request.ray_flags & ray_flag::accept_first_hit_and_end_search) != 0;
}

template <Order order, class Result>
void interleave(AddressSpace addresses, const RayRun& rays, Result* results) {
  if (header_of(rays.shared->structure).kind == StructureKind::instances)
    Interleaver<order, true, Result>(addresses, rays, results).run();
  else
    Interleaver<order, false, Result>(addresses, rays, results).run();
}

/// Whether rays may find anything at all in the structure.
inline bool worth_entering(const TraceRequest& request) {
  if (!request.structure) return false;
  const StructureHeader& header = header_of(request.structure);
  if (header.kind == StructureKind::instances) return header.root != no_index;
  return wants(request, header);
}

/// Closest hits of rays that may find something and do not go together.
inline void trace_apart(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  constexpr size_t worth_interleaving = 4;
  if (rays.count < worth_interleaving)
    trace_one_by_one(addresses, rays, hits);
  else
    interleave<Order::distance>(addresses, rays, hits);
}

#ifdef HWY_TARGET_INCLUDE
/// Groups of rays that go together as packets, the others apart; those of short runs are brought together so that they
/// have company. Packets: TrianglePackets or InstancePackets.
template <class Packets>
class PacketBatch {
 public:
  PacketBatch(AddressSpace addresses, const RayRun& rays, Hit* hits)
      : addresses_(addresses), rays_(rays), hits_(hits), packets_(addresses, rays) {}

  /// Returns the number of rays traced in packets.
  size_t run() {
    size_t begin = 0;  // of a run of groups that are no packets
    for (size_t i = 0; i + packet_size <= rays_.count; i += packet_size) {
      const uint32_t left = packets_.trace(i, &hits_[i]);
      if (left == all_rays) continue;
      trace_others(begin, i);
      begin = i + packet_size;
      for (uint32_t ray = left; ray != 0; ray &= ray - 1) add_stray(i + static_cast<size_t>(std::countr_zero(ray)));
    }
    trace_others(begin, rays_.count);
    trace_strays();
    return rays_.count - apart_;
  }

 private:
  static constexpr size_t long_run = 8 * packet_size;

  void add_stray(size_t i) {
    strays_.push_back(rays_[i]);
    stray_hits_.push_back(&hits_[i]);
  }

  void trace_others(size_t begin, size_t end) {
    if (end - begin >= long_run) {
      apart_ += end - begin;
      trace_apart(addresses_, rays_.part(begin, end - begin), &hits_[begin]);
    } else {
      for (size_t i = begin; i < end; ++i) add_stray(i);
    }
  }

  void trace_strays() {
    if (strays_.empty()) return;
    apart_ += strays_.size();
    std::vector<Hit> found(strays_.size());
    trace_apart(addresses_, {rays_.shared, strays_.data(), sizeof(Ray), strays_.size()}, found.data());
    for (size_t i = 0; i < found.size(); ++i) *stray_hits_[i] = found[i];
  }

  AddressSpace addresses_;
  RayRun rays_;
  Hit* hits_;
  size_t apart_ = 0;
  std::vector<Ray> strays_;
  std::vector<Hit*> stray_hits_;
  Packets packets_;
};

/// Returns the number of rays traced in packets, at least packet_size of which are given.
inline size_t trace_in_packets(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  if (header_of(rays.shared->structure).kind == StructureKind::instances)
    return PacketBatch<InstancePackets>(addresses, rays, hits).run();
  return PacketBatch<TrianglePackets>(addresses, rays, hits).run();
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

inline void trace_run(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  constexpr size_t worth_interleaving = 4;
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
  if (!rays.shared->candidate && worth_entering(*rays.shared))
    return interleave<Order::stored>(addresses, rays, results);
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
    const size_t last = std::min(requests.size(), begin + longest_run);
    while (end < last && same_run(requests[begin], requests[end])) ++end;
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
