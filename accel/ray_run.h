#pragma once

#include <rayloom/accel/structure.h>
#include <rayloom/accel/trace.h>

#include <cstddef>

namespace rayloom::accel {

/// Rays that share everything but themselves. They lie `stride` bytes apart, alone or inside requests.
struct RayRun {
  const TraceRequest* shared;  ///< its own ray is not looked at
  const Ray* first;
  size_t stride;
  size_t count;

  const Ray& operator[](size_t i) const {
    return *reinterpret_cast<const Ray*>(reinterpret_cast<const std::byte*>(first) + i * stride);
  }
  /// Of the first ray of a part().
  size_t index_of(const RayRun& part) const {
    return static_cast<size_t>(reinterpret_cast<const std::byte*>(part.first) -
                               reinterpret_cast<const std::byte*>(first)) /
           stride;
  }
  RayRun part(size_t begin, size_t length) const { return {shared, &(*this)[begin], stride, length}; }
};

/// Requests that agree in all but the ray.
inline RayRun run_of(std::span<const TraceRequest> requests) {
  return {requests.data(), &requests.data()->ray, sizeof(TraceRequest), requests.size()};
}

/// Whether a candidate function, had the request one, would never be called: all that rays may hit is opaque triangles.
inline bool never_asks(const TraceRequest& request) {
  if (!request.structure) return true;
  const StructureHeader& header = header_of(request.structure);
  return header.kind == StructureKind::triangles && header.non_opaque_count == 0 &&
         !(request.ray_flags & ray_flag::force_non_opaque);
}

/// Whether two requests can be in one run. `silent`: never_asks(a); otherwise `a` has no candidate function, which
/// would be called ray by ray.
inline bool same_run(const TraceRequest& a, const TraceRequest& b, bool silent) {
  return a.structure == b.structure && a.ray_flags == b.ray_flags && a.instance_mask == b.instance_mask &&
         (silent || !b.candidate);
}

}  // namespace rayloom::accel
