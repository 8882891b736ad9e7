#pragma once

// The point of a surface that a ray hit: where it is, which way it faces, and its interpolated attributes.

#include <rayloom/shaders/scene_view.h>
#include <rayloom/shaders/spawn.h>

#include <array>

namespace rayloom::shaders {

/// Interpolated vertex attributes.
struct Attributes {
  std::array<float2, 2> uv{float2(0), float2(0)};
  float4 color{1};
};

struct Surface {
  SpawnPoint spawn;
  float3 geometric_normal;  ///< unit, on the ray's side
  float3 shading_normal;    ///< unit, interpolated, on the side of geometric_normal; not yet bent by a normal map
  float3 tangent;           ///< unit where there is one, else 0
  float bitangent_sign;     ///< of cross(shading_normal, tangent); 0: no tangent frame
  bool front;               ///< the ray came from the front
  Attributes attributes;

  float3 position() const { return float3(spawn.position); }
};

/// What a hit shader knows of the primitive it is about.
struct HitInstance {
  float3x4 object_to_world, world_to_object;
};

template <class Context>
HitInstance hit_instance(const Context& ctx) {
  return {ctx.ObjectToWorld3x4(), ctx.WorldToObject3x4()};
}

/// Where the ray meets the primitive, in object space, as far as t says.
template <class Context>
double3 object_hit_point(const Context& ctx) {
  return double3(ctx.ObjectRayOrigin()) + double{ctx.RayTCurrent()} * double3(ctx.ObjectRayDirection());
}

/// Vertex numbers of a triangle.
uint3 triangle_indices(const TriangleRecord& record, uint32_t primitive);

/// Of triangle `primitive` at `barycentrics` (weights of vertices 1 and 2). Loads only what the geometry has.
Attributes interpolate_attributes(const TriangleRecord& record, uint3 vertices, float2 barycentrics);

/// `tangents`: whether a tangent frame is wanted, for a normal map on uv set `tangent_uv_set`.
Surface triangle_surface(const TriangleRecord& record, uint32_t primitive, float2 barycentrics, bool front,
                         const HitInstance& instance, bool tangents, uint32_t tangent_uv_set);

/// Of a sphere hit at `object_point` (approximately).
Surface sphere_surface(const scenes::Sphere& sphere, double3 object_point, bool front, const HitInstance& instance);

}  // namespace rayloom::shaders
