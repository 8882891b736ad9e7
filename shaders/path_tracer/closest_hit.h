#pragma once

#include <rayloom/shaders/material.h>
#include <rayloom/shaders/path_tracer/payload.h>
#include <rayloom/shaders/path_tracer/settings.h>
#include <rayloom/shaders/sphere.h>
#include <rayloom/shaders/surface.h>

namespace rayloom::shaders {

/// A surface with its material, as path vertices see it.
struct PathVertex {
  Surface surface;
  uint32_t material;
  MaterialCore core;
  uint32_t light;  ///< the triangle light hit, or no_light
};

/// Emission, one light sample and one BSDF sample of a path vertex; fills the payload.
void shade_path_vertex(ClosestHitContext& ctx, const PathTracerSettings& settings, const PathVertex& vertex,
                       PathPayload& payload);

struct PathTracerTriangleHit {
  PathTracerSettings settings;

  void operator()(ClosestHitContext& ctx, PathPayload& payload,
                  const BuiltInTriangleIntersectionAttributes& hit) const {
    const auto record = ctx.LocalRoot<TriangleRecord>();
    PathVertex vertex;
    vertex.material = record.material;
    vertex.core = load_material(settings.scene.materials, record.material);
    const NormalMap map = material_normal_map(settings.scene.materials, record.material, vertex.core);
    vertex.surface =
        triangle_surface(record, ctx.PrimitiveIndex(), hit.barycentrics, ctx.HitKind() == HIT_KIND_TRIANGLE_FRONT_FACE,
                         hit_instance(ctx), map.has, map.uv_set);
    vertex.light = vertex.core.emits() ? find_light(ctx) : no_light;
    shade_path_vertex(ctx, settings, vertex, payload);
  }

 private:
  uint32_t find_light(const ClosestHitContext& ctx) const;
};

struct PathTracerSphereHit {
  PathTracerSettings settings;

  void operator()(ClosestHitContext& ctx, PathPayload& payload, const SphereAttributes&) const {
    const auto record = ctx.LocalRoot<SphereRecord>();
    PathVertex vertex;
    vertex.material = record.material;
    vertex.core = load_material(settings.scene.materials, record.material);
    vertex.surface = sphere_surface(record.spheres[ctx.PrimitiveIndex()], object_hit_point(ctx),
                                    ctx.HitKind() == hit_kind_outside, hit_instance(ctx));
    vertex.light = no_light;
    shade_path_vertex(ctx, settings, vertex, payload);
  }
};

}  // namespace rayloom::shaders
