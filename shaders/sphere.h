#pragma once

// Spheres as procedural primitives: their boxes, and the intersection shader.

#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/stage_context.h>
#include <rayloom/shaders/scene_view.h>
#include <rayloom/shaders/spawn.h>

#include <optional>

namespace rayloom::shaders {

inline constexpr uint32_t hit_kind_outside = 0, hit_kind_inside = 1;

/// A box around a sphere, rounded outward.
RAYTRACING_AABB sphere_box(const scenes::Sphere& sphere);

struct SphereCrossings {
  double enter, leave;
};
/// Where the line origin + t direction meets the sphere, if it does. In double by Hearn and Baker's form (Haines et
/// al., Ray Tracing Gems, chapter 7): the discriminant from the nearest point, the roots without cancellation.
std::optional<SphereCrossings> intersect_sphere(const scenes::Sphere& sphere, float3 origin, float3 direction);

/// Attributes of a sphere hit: none, shaders work the normal out from the hit point.
struct SphereAttributes {
  uint32_t reserved = 0;
};

struct SphereIntersection {
  IntersectionVerdict operator()(IntersectionContext& ctx) const {
    const SphereRecord record = ctx.LocalRoot<SphereRecord>();
    const scenes::Sphere sphere = record.spheres[ctx.PrimitiveIndex()];
    const auto crossings = intersect_sphere(sphere, ctx.ObjectRayOrigin(), ctx.ObjectRayDirection());
    if (!crossings) return ctx.EndIntersection();
    const auto enter = static_cast<float>(crossings->enter), leave = static_cast<float>(crossings->leave);
    if (enter >= ctx.RayTMin()) return ctx.ReportHit(enter, hit_kind_outside, SphereAttributes{});
    return ctx.ReportHit(leave, hit_kind_inside, SphereAttributes{});
  }
};

}  // namespace rayloom::shaders
