#include <rayloom/tools/bench/traced_rays.h>

#include <rayloom/base/parallel.h>

#include <algorithm>
#include <vector>

namespace rayloom::bench {
namespace {

constexpr uint64_t part = 8192;  ///< rays a task

void trace_hits(const accel::TraceRequest& shared, std::span<const accel::Ray> rays, std::span<accel::Hit> hits) {
  accel::trace({}, shared, rays, hits);
}

/// As the peer's occlusion call does, this tells only whether there is a hit.
void tell_occlusion(const accel::TraceRequest& shared, std::span<const accel::Ray> rays, std::span<accel::Hit> hits) {
  std::vector<uint8_t> hidden(rays.size());
  accel::occluded({}, shared, rays, hidden);
  for (size_t i = 0; i < rays.size(); ++i) hits[i].type = hidden[i] ? accel::HitType::triangle : accel::HitType::none;
}

}  // namespace

TraceRays trace_in_batches(const OurStructure& structure, uint32_t ray_flags, size_t batch) {
  return [&structure, ray_flags, batch](std::span<const accel::Ray> rays, std::span<accel::Hit> hits) {
    const accel::TraceRequest shared = structure.request({}, ray_flags);
    const bool any_hit = (ray_flags & accel::ray_flag::accept_first_hit_and_end_search) != 0;
    for (size_t begin = 0; begin < rays.size(); begin += batch) {
      const size_t count = std::min(batch, rays.size() - begin);
      const auto trace = any_hit ? tell_occlusion : trace_hits;
      trace(shared, rays.subspan(begin, count), hits.subspan(begin, count));
    }
  };
}

TraceRays trace_one_by_one(const OurStructure& structure, uint32_t ray_flags) {
  return [&structure, ray_flags](std::span<const accel::Ray> rays, std::span<accel::Hit> hits) {
    for (size_t i = 0; i < rays.size(); ++i) hits[i] = accel::trace({}, structure.request(rays[i], ray_flags));
  };
}

void trace_all(const TraceRays& trace, std::span<const accel::Ray> rays, std::span<accel::Hit> hits, unsigned threads) {
  if (threads == 1) return trace(rays, hits);
  parallel_for(rays.size(), part, [&](uint64_t begin, uint64_t end) {
    trace(rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
  });
}

}  // namespace rayloom::bench
