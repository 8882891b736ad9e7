#pragma once

// What a material says at a point of a surface: factors times vertex colours times textures, as glTF 2.0 defines them.

#include <rayloom/shaders/surface.h>

namespace rayloom::shaders {

/// A material's parameters at one point. Colours are linear and clamped to 0..1.
struct MaterialPoint {
  float3 base_color{1};
  float metallic = 0;
  float roughness = 1;
};

MaterialCore load_material(const MaterialView& view, uint32_t material);

/// Coverage, 0..1: base colour alpha times its texture's times the vertex colour's.
float material_alpha(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at);
float3 material_base_color(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at);
MaterialPoint evaluate_material(const MaterialView& view, uint32_t material, const MaterialCore& core,
                                const Attributes& at);
/// Radiance emitted from the lit side; does not look at which side that is.
float3 material_emission(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at);
/// Ambient occlusion as the file bakes it, 0..1. Path tracing finds occlusion itself and ignores this.
float material_occlusion(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at);

/// The uv set a normal map needs tangents for; `has` says whether there is a normal map.
struct NormalMap {
  bool has = false;
  uint32_t uv_set = 0;
};
NormalMap material_normal_map(const MaterialView& view, uint32_t material, const MaterialCore& core);

/// The shading normal after the normal map, turned where necessary so that it faces the viewer and mirrors him out of
/// the surface: unit, and dot(normal, to_viewer) > 0.
float3 shading_normal(const MaterialView& view, uint32_t material, const MaterialCore& core, const Surface& surface,
                      float3 to_viewer);

/// Whether a candidate hit counts: mask compares with the cutoff, blend with a random number in [0, 1).
inline bool covers(const MaterialCore& core, float alpha, float random) {
  if (core.flags & material_flag::mask) return alpha >= core.alpha_cutoff;
  return !(core.flags & material_flag::blend) || random < alpha;
}
/// The share of hits that count.
inline float coverage(const MaterialCore& core, float alpha) {
  if (core.flags & material_flag::mask) return alpha >= core.alpha_cutoff ? 1.0f : 0.0f;
  return (core.flags & material_flag::blend) ? alpha : 1.0f;
}

}  // namespace rayloom::shaders
