#include <rayloom/tools/bench/traced_rays.h>

#include <rayloom/base/parallel.h>

#include <algorithm>

namespace rayloom::bench {
namespace {

constexpr uint64_t part = 8192;  ///< rays a task

}  // namespace

TraceRays trace_in_batches(const OurStructure& structure, uint32_t ray_flags, size_t batch) {
  return [&structure, ray_flags, batch](std::span<const accel::Ray> rays, std::span<accel::Hit> hits) {
    std::vector<accel::TraceRequest> requests(std::min(batch, rays.size()), structure.request({}, ray_flags));
    for (size_t begin = 0; begin < rays.size(); begin += batch) {
      const size_t count = std::min(batch, rays.size() - begin);
      for (size_t i = 0; i < count; ++i) requests[i].ray = rays[begin + i];
      accel::trace({}, std::span(requests).first(count), hits.subspan(begin, count));
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
