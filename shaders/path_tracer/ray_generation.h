#pragma once

#include <rayloom/shaders/camera.h>
#include <rayloom/shaders/film.h>
#include <rayloom/shaders/path_tracer/payload.h>
#include <rayloom/shaders/path_tracer/settings.h>
#include <rayloom/shaders/shadow_ray.h>

namespace rayloom::shaders {

/// Walks paths: one TraceRay a vertex and one shadow ray a light sample, both from here, so that no shader recurses.
struct PathTracerRayGeneration {
  PathTracerSettings settings;
  Camera camera;

  void operator()(RayGenContext& ctx) const {
    add_samples(ctx,
                [&](const Sampler& sampler, uint2 pixel, PixelSums& sums) { trace_path(ctx, sampler, pixel, sums); });
  }

 private:
  void trace_path(RayGenContext& ctx, Sampler sampler, uint2 pixel, PixelSums& sums) const {
    RayDesc ray = camera.ray(float2(pixel) + sampler.next_2d());
    PathPayload vertex{};
    vertex.sampler = sampler;
    float3 radiance(0), throughput(1);
    float alpha = 1;
    for (uint32_t bounce = 0;; ++bounce) {
      vertex.bounces_left = settings.max_bounces - bounce;
      ctx.TraceRay(settings.scene.structure, RAY_FLAG_NONE, 0xFF, 0, settings.scene.ray_types, 0, ray, vertex);
      if (bounce == 0) alpha = vertex.hit ? 1.0f : 0.0f;
      radiance += throughput * vertex.emitted;
      if (light_reaches(ctx, vertex)) radiance += throughput * vertex.direct;
      if (vertex.pdf == 0) break;
      throughput *= vertex.weight;
      if (bounce >= roulette_start && !survives(vertex.roulette, throughput)) break;
      ray = {vertex.origin, 0, vertex.direction, INFINITY};
    }
    sums.add(radiance, alpha);
  }

  bool light_reaches(RayGenContext& ctx, const PathPayload& vertex) const {
    if (!(vertex.shadow_t_max > 0)) return false;
    return visible(ctx, settings.scene, {vertex.origin, 0, vertex.shadow, vertex.shadow_t_max}, vertex.path_key());
  }

  /// Russian roulette: ends paths in proportion to what they have lost and strengthens the rest, so that the mean
  /// stays.
  static bool survives(float random, float3& throughput) {
    const float chance = largest_component(throughput);
    if (chance >= 1) return true;
    if (!(random < chance)) return false;
    throughput /= chance;
    return true;
  }

  static constexpr uint32_t roulette_start = 2;
};

}  // namespace rayloom::shaders
