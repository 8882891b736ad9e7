#pragma once

// Visibility rays: is anything between a point and a light?

#include <rayloom/runtime/stage_context.h>
#include <rayloom/shaders/alpha_test.h>
#include <rayloom/shaders/scene_view.h>

namespace rayloom::shaders {

struct ShadowPayload {
  uint64_t key;
  uint32_t visible;  ///< set by the miss shader

  uint64_t path_key() const { return key; }
};

struct ShadowMiss {
  void operator()(MissContext&, ShadowPayload& payload) const { payload.visible = 1; }
};

/// Index of ShadowMiss in every miss table; radiance rays use 0.
inline constexpr uint32_t shadow_miss_index = 1;

/// The last ray type: shadow rays have hit records of their own only where shaders decide hits.
inline uint32_t shadow_ray_type(const SceneView& scene) { return scene.ray_types - 1; }

template <class Context>
bool visible(Context& ctx, const SceneView& scene, const RayDesc& ray, uint64_t path_key) {
  ShadowPayload payload{path_key, 0};
  ctx.TraceRay(scene.structure, RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH | RAY_FLAG_SKIP_CLOSEST_HIT_SHADER, 0xFF,
               shadow_ray_type(scene), scene.ray_types, shadow_miss_index, ray, payload);
  return payload.visible != 0;
}

}  // namespace rayloom::shaders
