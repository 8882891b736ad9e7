#include <rayloom/shaders/bsdf.h>
#include <rayloom/shaders/lights.h>
#include <rayloom/shaders/path_tracer/closest_hit.h>

#include <algorithm>

namespace rayloom::shaders {
namespace {

/// Directions closer to the surface's plane than this carry less than a millionth; those below SpawnPoint::grazing may
/// meet it again.
constexpr float edge_on = 1e-6f;

float3 emitted_towards_ray(const ClosestHitContext& ctx, const PathTracerSettings& settings, const PathVertex& vertex,
                           float bsdf_pdf) {
  const bool lit_side = vertex.surface.front || (vertex.core.flags & material_flag::double_sided);
  if (!vertex.core.emits() || !lit_side) return float3(0);
  float light_pdf = 0;
  if (vertex.light != no_light && bsdf_pdf > 0) {
    const float cosine = -glm::dot(vertex.surface.geometric_normal, ctx.WorldRayDirection());
    light_pdf = triangle_light_pdf(settings.scene.lights, vertex.light, ctx.RayTCurrent(), cosine) /
                static_cast<float>(settings.scene.light_kinds());
  }
  return material_emission(settings.scene.materials, vertex.material, vertex.core, vertex.surface.attributes) *
         bsdf_sample_weight(settings.estimator, bsdf_pdf, light_pdf);
}

/// A shading point: BSDF, its frame, and the side of the surface light must come from.
struct ShadingPoint {
  Bsdf bsdf;
  Frame frame;
  float3 wo;
  float3 geometric_normal;
  float least_cosine;

  bool may_leave(float3 direction) const { return glm::dot(direction, geometric_normal) > least_cosine; }
};

ShadingPoint make_shading_point(const ClosestHitContext& ctx, const PathTracerSettings& settings,
                                const PathVertex& vertex) {
  const MaterialView& materials = settings.scene.materials;
  const float3 to_viewer = -ctx.WorldRayDirection();
  const MaterialPoint point = evaluate_material(materials, vertex.material, vertex.core, vertex.surface.attributes);
  ShadingPoint shading;
  shading.frame = make_frame(shading_normal(materials, vertex.material, vertex.core, vertex.surface, to_viewer));
  shading.wo = shading.frame.to_local(to_viewer);
  shading.geometric_normal = vertex.surface.geometric_normal;
  shading.least_cosine = std::max(edge_on, static_cast<float>(vertex.surface.spawn.grazing));
  shading.bsdf = with_specular_chance(
      metallic_roughness(point.base_color, point.metallic, point.roughness, settings.dielectric_specular), shading.wo);
  return shading;
}

/// One light of one kind, chosen with equal chance among the kinds the scene has.
void sample_direct(ClosestHitContext& ctx, const PathTracerSettings& settings, const ShadingPoint& shading,
                   PathPayload& payload) {
  const auto kinds = static_cast<float>(settings.scene.light_kinds());
  const float4 random = payload.sampler.next_4d();
  const float scaled = random.z * kinds;
  const auto kind = static_cast<uint32_t>(scaled);
  LightSample light{};
  light.position = payload.origin;
  light.choice = random.w;
  light.u = {random.x, random.y};
  ctx.CallShader(kind, light);
  if (!(light.pdf > 0) || !shading.may_leave(light.direction)) return;
  if (settings.estimator == Estimator::bsdf_sampling && !light.delta) return;

  const float light_pdf = light.pdf / kinds;
  const BsdfValue value = evaluate_bsdf(shading.bsdf, shading.wo, shading.frame.to_local(light.direction));
  const float weight = light.delta ? 1.0f : light_sample_weight(settings.estimator, light_pdf, value.pdf);
  payload.direct = value.reflected * light.radiance * (weight / light_pdf);
  if (!(largest_component(payload.direct) > 0)) return;
  payload.shadow = light.to_light;
  payload.shadow_t_max = light.t_max;
}

void sample_next(const ShadingPoint& shading, PathPayload& payload) {
  const float4 random = payload.sampler.next_4d();
  const BsdfSample sample = sample_bsdf(shading.bsdf, shading.wo, random.z, {random.x, random.y});
  payload.direction = shading.frame.to_world(sample.wi);
  payload.weight = sample.weight;
  payload.roulette = random.w;
  const bool goes_on = shading.may_leave(payload.direction) && largest_component(sample.weight) > 0;
  payload.pdf = goes_on ? sample.pdf : 0.0f;
}

}  // namespace

void shade_path_vertex(ClosestHitContext& ctx, const PathTracerSettings& settings, const PathVertex& vertex,
                       PathPayload& payload) {
  payload.emitted = emitted_towards_ray(ctx, settings, vertex, payload.pdf);
  payload.hit = 1;
  payload.pdf = 0;
  payload.shadow_t_max = 0;
  if (payload.bounces_left == 0) return;
  const ShadingPoint shading = make_shading_point(ctx, settings, vertex);
  payload.origin = vertex.surface.spawn.origin(vertex.surface.front);
  if (settings.scene.light_kinds() > 0) sample_direct(ctx, settings, shading, payload);
  sample_next(shading, payload);
}

uint32_t PathTracerTriangleHit::find_light(const ClosestHitContext& ctx) const {
  return find_triangle_light(settings.scene.lights, ctx.InstanceIndex(), ctx.GeometryIndex(), ctx.PrimitiveIndex());
}

}  // namespace rayloom::shaders
