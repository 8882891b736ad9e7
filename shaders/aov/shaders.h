#pragma once

// The AOV program: the first hit at the centre of each pixel, unfiltered, as channels or as one of the debug views.

#include <rayloom/shaders/aov/payload.h>
#include <rayloom/shaders/aov/views.h>
#include <rayloom/shaders/camera.h>
#include <rayloom/shaders/film.h>
#include <rayloom/shaders/material.h>
#include <rayloom/shaders/sphere.h>
#include <rayloom/shaders/surface.h>

namespace rayloom::shaders {

/// Writes a view's colour to the film, or the whole payload to `channels` if that is set.
struct AovRayGeneration {
  SceneView scene;
  Camera camera;
  AovView view = AovView::shading_normal;
  RWStructuredBuffer<AovPayload> channels{};

  void operator()(RayGenContext& ctx) const {
    const auto film = ctx.GlobalRoot<FilmArguments>();
    const uint2 pixel = film.pixel(ctx.DispatchRaysIndex());
    AovPayload payload;
    payload.key = (uint64_t{pixel.y} << 32) | pixel.x;
    ctx.TraceRay(scene.structure, RAY_FLAG_NONE, 0xFF, 0, scene.ray_types, 0, camera.ray_through_centre(pixel),
                 payload);
    if (payload.hit()) payload.depth = camera.depth(payload.position);
    const uint64_t slot = film.slot(ctx.DispatchRaysIndex());
    if (channels.count > 0) {
      channels[slot] = payload;
      return;
    }
    PixelSums sums;
    sums.add(view_color(view, payload), payload.hit() ? 1.0f : 0.0f);
    film.pixels[slot] = sums;
  }
};

/// Both hit shaders end here.
void fill_aov(const ClosestHitContext& ctx, const MaterialView& materials, const Surface& surface, uint32_t material,
              AovPayload& payload);

struct AovTriangleHit {
  MaterialView materials;

  void operator()(ClosestHitContext& ctx, AovPayload& payload, const BuiltInTriangleIntersectionAttributes& hit) const {
    const auto record = ctx.LocalRoot<TriangleRecord>();
    const NormalMap map = material_normal_map(materials, record.material, load_material(materials, record.material));
    fill_aov(ctx, materials,
             triangle_surface(record, ctx.PrimitiveIndex(), hit.barycentrics,
                              ctx.HitKind() == HIT_KIND_TRIANGLE_FRONT_FACE, hit_instance(ctx), map.has, map.uv_set),
             record.material, payload);
  }
};

struct AovSphereHit {
  MaterialView materials;

  void operator()(ClosestHitContext& ctx, AovPayload& payload, const SphereAttributes&) const {
    const auto record = ctx.LocalRoot<SphereRecord>();
    fill_aov(ctx, materials,
             sphere_surface(record.spheres[ctx.PrimitiveIndex()], object_hit_point(ctx),
                            ctx.HitKind() == hit_kind_outside, hit_instance(ctx)),
             record.material, payload);
  }
};

inline void AovMiss(MissContext&, AovPayload&) {}

}  // namespace rayloom::shaders
