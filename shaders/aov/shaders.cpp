#include <rayloom/shaders/aov/shaders.h>

namespace rayloom::shaders {

void fill_aov(const ClosestHitContext& ctx, const MaterialView& materials, const Surface& surface, uint32_t material,
              AovPayload& payload) {
  const MaterialCore core = load_material(materials, material);
  payload.position = surface.position();
  payload.ray_t = ctx.RayTCurrent();
  payload.normal = surface.geometric_normal;
  payload.facing = surface.front ? 1.0f : -1.0f;
  payload.shading_normal = shading_normal(materials, material, core, surface, -ctx.WorldRayDirection());
  payload.albedo = material_base_color(materials, material, core, surface.attributes);
  payload.occlusion = material_occlusion(materials, material, core, surface.attributes);
  payload.uv = surface.attributes.uv[0];
  payload.instance = ctx.InstanceIndex();
  payload.geometry = ctx.GeometryIndex();
  payload.primitive = ctx.PrimitiveIndex();
  payload.material = material;
}

}  // namespace rayloom::shaders
