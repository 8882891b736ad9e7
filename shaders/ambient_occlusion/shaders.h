#pragma once

// Ambient occlusion: the cosine-weighted share of the hemisphere over the first hit that nothing blocks within a
// distance.

#include <rayloom/shaders/camera.h>
#include <rayloom/shaders/film.h>
#include <rayloom/shaders/material.h>
#include <rayloom/shaders/sampler.h>
#include <rayloom/shaders/shadow_ray.h>
#include <rayloom/shaders/sphere.h>
#include <rayloom/shaders/surface.h>
#include <rayloom/shaders/warp.h>

namespace rayloom::shaders {

/// What the first hit tells ray generation, which then casts the occlusion ray.
struct OcclusionPayload {
  uint64_t key;
  float3 origin;
  uint32_t hit;
  float3 normal;  ///< geometric, on the viewer's side
  float grazing;  ///< SpawnPoint::grazing

  uint64_t path_key() const { return key; }
};

struct OcclusionRayGeneration {
  SceneView scene;
  Camera camera;
  float distance;

  void operator()(RayGenContext& ctx) const {
    add_samples(ctx,
                [&](const Sampler& sampler, uint2 pixel, PixelSums& sums) { add_sample(ctx, sampler, pixel, sums); });
  }

 private:
  void add_sample(RayGenContext& ctx, Sampler sampler, uint2 pixel, PixelSums& sums) const {
    const RayDesc ray = camera.ray(float2(pixel) + sampler.next_2d());
    OcclusionPayload payload{};
    payload.key = sampler.path_key();
    ctx.TraceRay(scene.structure, RAY_FLAG_NONE, 0xFF, 0, scene.ray_types, 0, ray, payload);
    if (!payload.hit) return sums.add(float3(1), 0);
    float3 local = cosine_hemisphere(sampler.next_2d());
    local.z = std::fmax(local.z, payload.grazing);
    const float3 direction = make_frame(payload.normal).to_world(local);
    const bool open = visible(ctx, scene, {payload.origin, 0, direction, distance}, sampler.path_key());
    sums.add(float3(open ? 1.0f : 0.0f), 1);
  }
};

inline void fill_occlusion(const Surface& surface, OcclusionPayload& payload) {
  payload.origin = surface.spawn.origin(surface.front);
  payload.normal = surface.geometric_normal;
  payload.grazing = static_cast<float>(surface.spawn.grazing);
  payload.hit = 1;
}

inline void OcclusionTriangleHit(ClosestHitContext& ctx, OcclusionPayload& payload,
                                 const BuiltInTriangleIntersectionAttributes& hit) {
  fill_occlusion(triangle_surface(ctx.LocalRoot<TriangleRecord>(), ctx.PrimitiveIndex(), hit.barycentrics,
                                  ctx.HitKind() == HIT_KIND_TRIANGLE_FRONT_FACE, hit_instance(ctx), false, 0),
                 payload);
}

inline void OcclusionSphereHit(ClosestHitContext& ctx, OcclusionPayload& payload, const SphereAttributes&) {
  const scenes::Sphere sphere = ctx.LocalRoot<SphereRecord>().spheres[ctx.PrimitiveIndex()];
  fill_occlusion(sphere_surface(sphere, object_hit_point(ctx), ctx.HitKind() == hit_kind_outside, hit_instance(ctx)),
                 payload);
}

inline void OcclusionMiss(MissContext&, OcclusionPayload& payload) { payload.hit = 0; }

}  // namespace rayloom::shaders
