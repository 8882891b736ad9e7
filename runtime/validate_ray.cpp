#include <rayloom/runtime/ray_frame.h>

#include <bit>
#include <cmath>

namespace rayloom::detail {
namespace {

bool finite(const float3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool any_nan(const float3& v) { return std::isnan(v.x) || std::isnan(v.y) || std::isnan(v.z); }

void validate_extents(const Lane& lane, const RayDesc& ray) {
  const bool nan = any_nan(ray.Origin) || any_nan(ray.Direction) || std::isnan(ray.TMin) || std::isnan(ray.TMax);
  if (nan || ray.TMin < 0 || ray.TMin > ray.TMax) {
    lane.report("TR-17", [&] {
      return nan ? std::string("the ray has a NaN; it misses")
                 : "TMin " + std::to_string(ray.TMin) + " and TMax " + std::to_string(ray.TMax) +
                       " are no interval from 0 up; the ray misses";
    });
    return;
  }
  const bool zero = ray.Direction == float3(0.0f);
  if (zero || !finite(ray.Origin) || !finite(ray.Direction))
    lane.report("TR-18", [&] {
      return std::string(zero ? "the ray's direction is zero" : "the ray's origin or direction is infinite") +
             "; it misses";
    });
}

void report_if(const Lane& lane, bool wrong, std::string_view row, const char* text) {
  if (wrong) lane.report(row, [&] { return std::string(text); });
}

}  // namespace

void validate_ray(const Lane& lane, const TraceRayArguments& arguments, uint32_t pipeline_flags) {
  constexpr uint cull_facing = RAY_FLAG_CULL_BACK_FACING_TRIANGLES | RAY_FLAG_CULL_FRONT_FACING_TRIANGLES;
  constexpr uint opacity =
      RAY_FLAG_FORCE_OPAQUE | RAY_FLAG_FORCE_NON_OPAQUE | RAY_FLAG_CULL_OPAQUE | RAY_FLAG_CULL_NON_OPAQUE;
  const uint flags = arguments.flags | pipeline_flags;
  const bool skips_triangles = flags & RAY_FLAG_SKIP_TRIANGLES;
  validate_extents(lane, arguments.desc);
  report_if(lane, (flags & cull_facing) == cull_facing, "RF-10", "both facing culls are set; every triangle is culled");
  report_if(lane, std::popcount(flags & opacity) > 1, "RF-12",
            "more than one of FORCE_OPAQUE, FORCE_NON_OPAQUE, CULL_OPAQUE, CULL_NON_OPAQUE is set; forces apply before "
            "culls, FORCE_OPAQUE before FORCE_NON_OPAQUE");
  report_if(lane, skips_triangles && (flags & (cull_facing | RAY_FLAG_SKIP_PROCEDURAL_PRIMITIVES)), "RF-14",
            "SKIP_TRIANGLES is set together with a facing cull or SKIP_PROCEDURAL_PRIMITIVES");
  report_if(lane, arguments.flags & ~defined_ray_flags, "RF-17", "undefined ray flags are set; they are dropped");
}

}  // namespace rayloom::detail
