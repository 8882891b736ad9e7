#include <rayloom/shaders/material.h>
#include <rayloom/shaders/texture_table.h>

namespace rayloom::shaders {
namespace {

scenes::TextureRef texture_ref(const MaterialView& view, uint32_t material, TextureSlot slot) {
  return view.texture_refs[uint64_t{material} * texture_slots + static_cast<uint32_t>(slot)];
}

float4 sample(const MaterialView& view, uint32_t material, TextureSlot slot, const Attributes& at) {
  const scenes::TextureRef ref = texture_ref(view, material, slot);
  const bool color = slot == TextureSlot::base_color || slot == TextureSlot::emissive;
  return view.textures->sample(ref, at.uv[ref.uv_set & 1u], color);
}

float4 base_color(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at) {
  const float4 color = core.base_color * at.color;
  return core.has(TextureSlot::base_color) ? color * sample(view, material, TextureSlot::base_color, at) : color;
}

/// The smallest cosines a shading normal may make with the view, and the view's mirror direction with the surface.
constexpr float least_view_cosine = 1e-3f;
constexpr float least_mirror_cosine = 1e-2f;

/// Turns a unit normal towards the viewer until it shows him its front.
float3 face_viewer(float3 normal, float3 to_viewer, float3 geometric_normal) {
  const float cosine = glm::dot(normal, to_viewer);
  if (cosine >= least_view_cosine) return normal;
  return normalize_or(normal + (2 * least_view_cosine - cosine) * to_viewer, geometric_normal);
}

/// Turns a normal that mirrors the view into the surface until the mirror direction just leaves it; else smooth metals
/// under normal maps have black rims. After Keller et al. 2017, "The Iray Light Transport Simulation".
float3 mirror_outward(float3 normal, float3 to_viewer, float3 geometric_normal) {
  const float3 mirrored = glm::reflect(-to_viewer, normal);
  const float cosine = glm::dot(mirrored, geometric_normal);
  if (cosine >= least_mirror_cosine) return normal;
  const float3 lifted = glm::normalize(mirrored + (least_mirror_cosine - cosine) * geometric_normal);
  return normalize_or(to_viewer + lifted, geometric_normal);
}

}  // namespace

MaterialCore load_material(const MaterialView& view, uint32_t material) { return view.cores[material]; }

float material_alpha(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at) {
  return saturate(base_color(view, material, core, at).w);
}

float3 material_base_color(const MaterialView& view, uint32_t material, const MaterialCore& core,
                           const Attributes& at) {
  return glm::clamp(float3(base_color(view, material, core, at)), float3(0), float3(1));
}

MaterialPoint evaluate_material(const MaterialView& view, uint32_t material, const MaterialCore& core,
                                const Attributes& at) {
  MaterialPoint point{material_base_color(view, material, core, at), core.metallic, core.roughness};
  if (core.has(TextureSlot::metallic_roughness)) {
    const float4 texel = sample(view, material, TextureSlot::metallic_roughness, at);
    point.roughness *= texel.y;
    point.metallic *= texel.z;
  }
  point.metallic = saturate(point.metallic);
  point.roughness = saturate(point.roughness);
  return point;
}

float3 material_emission(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at) {
  if (!core.has(TextureSlot::emissive)) return core.emissive;
  return core.emissive * glm::max(float3(sample(view, material, TextureSlot::emissive, at)), float3(0));
}

float material_occlusion(const MaterialView& view, uint32_t material, const MaterialCore& core, const Attributes& at) {
  return core.has(TextureSlot::occlusion) ? saturate(sample(view, material, TextureSlot::occlusion, at).x) : 1.0f;
}

NormalMap material_normal_map(const MaterialView& view, uint32_t material, const MaterialCore& core) {
  if (!core.has(TextureSlot::normal)) return {};
  return {true, texture_ref(view, material, TextureSlot::normal).uv_set & 1u};
}

float3 shading_normal(const MaterialView& view, uint32_t material, const MaterialCore& core, const Surface& surface,
                      float3 to_viewer) {
  float3 normal = surface.shading_normal;
  if (core.has(TextureSlot::normal) && surface.bitangent_sign != 0) {
    const float4 texel = sample(view, material, TextureSlot::normal, surface.attributes);
    const float2 slope = (2.0f * float2(texel) - 1.0f) * core.normal_scale;
    const float3 bitangent = surface.bitangent_sign * glm::cross(normal, surface.tangent);
    normal = normalize_or(slope.x * surface.tangent + slope.y * bitangent + (2.0f * texel.z - 1.0f) * normal, normal);
  }
  normal = face_viewer(normal, to_viewer, surface.geometric_normal);
  return mirror_outward(normal, to_viewer, surface.geometric_normal);
}

}  // namespace rayloom::shaders
