#include <rayloom/shaders/distribution.h>
#include <rayloom/shaders/environment.h>
#include <rayloom/shaders/lights.h>
#include <rayloom/shaders/material.h>
#include <rayloom/shaders/warp.h>

#include <cmath>

namespace rayloom::shaders {
namespace {

/// Cosines below this count as edge-on: what they carry is below a millionth, and their rounding is not bounded.
constexpr float edge_on = 1e-6f;

void no_light_sample(LightSample& sample) {
  sample.pdf = 0;
  sample.radiance = float3(0);
}

float3 light_emission(const SceneView& view, const TriangleLight& light, const MaterialCore& core,
                      float2 barycentrics) {
  const bool textured = core.has(TextureSlot::emissive) || (core.flags & (material_flag::mask | material_flag::blend));
  Attributes at;
  if (textured) {
    const TriangleRecord record = view.lights.geometries[light.geometry];
    at = interpolate_attributes(record, triangle_indices(record, light.primitive), barycentrics);
  }
  float3 emission = material_emission(view.materials, light.material, core, at);
  if (core.flags & (material_flag::mask | material_flag::blend))
    emission *= coverage(core, material_alpha(view.materials, light.material, core, at));
  return emission;
}

/// KHR_lights_punctual's recommended window: quadratic falloff, smoothly ending at `range`.
float range_window(float distance, float range) {
  return std::isinf(range) ? 1.0f : square(saturate(1.0f - square(square(distance / range))));
}

float cone(const PunctualLight& light, float3 from_light) {
  const float scale = 1.0f / std::fmax(0.001f, light.cos_inner_cone - light.cos_outer_cone);
  return square(saturate((glm::dot(light.direction, from_light) - light.cos_outer_cone) * scale));
}

bool is_kind(const PunctualLight& light, scenes::Light::Kind kind) { return light.kind == static_cast<uint32_t>(kind); }

}  // namespace

void sample_environment_light(const EnvironmentView& view, LightSample& sample) {
  const DirectionSample direction = sample_environment(view, sample.u);
  sample.to_light = sample.direction = direction.direction;
  sample.t_max = INFINITY;
  sample.pdf = direction.pdf;
  sample.radiance = environment_radiance(view, direction.direction);
  sample.delta = 0;
}

float triangle_light_pdf(const LightView& view, uint32_t light, float distance, float cosine) {
  const float density = view.triangles[light].density;
  return cosine > edge_on ? density * square(distance) / cosine : 0.0f;
}

void sample_triangle_light(const SceneView& view, LightSample& sample) {
  no_light_sample(sample);
  sample.delta = 0;
  const LightView& lights = view.lights;
  const Choice choice = choose(lights.triangle_table, 0, static_cast<uint32_t>(lights.triangles.count), sample.choice);
  const TriangleLight light = lights.triangles[choice.index];
  const float2 barycentrics = uniform_triangle(sample.u);
  const float3 offset_from_vertex = barycentrics.x * light.edge1 + barycentrics.y * light.edge2;
  const float3 away = (light.vertex - sample.position) + offset_from_vertex;
  const float distance = glm::length(away);
  if (!(distance > 0)) return;
  const float facing = -glm::dot(light.normal, away) / distance;
  const MaterialCore core = load_material(view.materials, light.material);
  if (facing < 0 && !(core.flags & material_flag::double_sided)) return;

  // Stop short of the light's plane by the bound on how far from it the ray's end may come to lie.
  const float clearance = light.error + 0x1p-21f * glm::dot(glm::abs(light.normal), glm::abs(away));
  sample.to_light = away + std::copysign(clearance, facing) * light.normal;
  sample.t_max = 1;
  sample.direction = away / distance;
  sample.pdf = std::fabs(facing) > edge_on ? light.density * square(distance) / std::fabs(facing) : 0.0f;
  sample.radiance = light_emission(view, light, core, barycentrics);
}

void sample_punctual_light(const LightView& view, LightSample& sample) {
  no_light_sample(sample);
  sample.delta = 1;
  const Choice choice = choose(view.punctual_table, 0, static_cast<uint32_t>(view.punctual.count), sample.choice);
  const PunctualLight light = view.punctual[choice.index];
  if (is_kind(light, scenes::Light::Kind::directional)) {
    sample.to_light = sample.direction = -light.direction;
    sample.t_max = INFINITY;
    sample.radiance = light.intensity;
    sample.pdf = choice.probability;
    return;
  }
  sample.to_light = light.position - sample.position;
  const float distance_squared = glm::dot(sample.to_light, sample.to_light);
  if (!(distance_squared > 0x1p-100f && distance_squared < INFINITY)) return;
  const float distance = std::sqrt(distance_squared);
  sample.direction = sample.to_light / distance;
  sample.t_max = 1;
  const float shape = is_kind(light, scenes::Light::Kind::spot) ? cone(light, -sample.direction) : 1.0f;
  sample.radiance = light.intensity * (shape * range_window(distance, light.range) / distance_squared);
  sample.pdf = choice.probability;
}

uint32_t find_triangle_light(const LightView& view, uint32_t instance, uint32_t geometry, uint32_t primitive) {
  if (view.triangles.count == 0) return no_light;
  const uint32_t emitters = view.instance_emitters[instance];
  if (emitters == no_light) return no_light;
  const uint32_t first = view.geometry_lights[uint64_t{emitters} + geometry];
  return first == no_light ? no_light : first + primitive;
}

}  // namespace rayloom::shaders
