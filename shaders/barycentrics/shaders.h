#pragma once

// The two shaders of the DXR lecture, nearly word for word: ray generation writes payload.color, closest hit writes the
// barycentrics and RayTCurrent().

#include <rayloom/runtime/stage_context.h>
#include <rayloom/shaders/camera.h>
#include <rayloom/shaders/film.h>
#include <rayloom/shaders/sphere.h>

namespace rayloom::shaders {

struct BarycentricsPayload {
  float4 color;
  float hitDistance;
  uint32_t pixel;

  uint64_t path_key() const { return pixel; }
};

struct BarycentricsRayGeneration {
  RaytracingAccelerationStructure scene;
  uint32_t ray_types;
  Camera camera;

  void operator()(RayGenContext& ctx) const {
    const auto film = ctx.GlobalRoot<FilmArguments>();
    const uint2 pixel = film.pixel(ctx.DispatchRaysIndex());
    const RayDesc ray = camera.ray_through_centre(pixel);
    BarycentricsPayload payload{float4(0), 0, pixel.y * camera.size.x + pixel.x};
    ctx.TraceRay(scene, RAY_FLAG_NONE, 0xFF, 0, ray_types, 0, ray, payload);
    PixelSums sums;
    sums.add(float3(payload.color), payload.color.w);
    film.pixels[film.slot(ctx.DispatchRaysIndex())] = sums;
  }
};

inline void BarycentricsClosestHit(ClosestHitContext& ctx, BarycentricsPayload& payload,
                                   const BuiltInTriangleIntersectionAttributes& attr) {
  const float2 b = attr.barycentrics;
  payload.color = float4(b.x, b.y, 1 - b.x - b.y, 1);
  payload.hitDistance = ctx.RayTCurrent();
}

/// A sphere has no barycentrics: white.
inline void BarycentricsSphereHit(ClosestHitContext& ctx, BarycentricsPayload& payload, const SphereAttributes&) {
  payload.color = float4(1);
  payload.hitDistance = ctx.RayTCurrent();
}

inline void BarycentricsMiss(MissContext&, BarycentricsPayload& payload) { payload.color = float4(0); }

}  // namespace rayloom::shaders
