#pragma once

// Light sampling: one emitter point or direction for a shading point, with its probability density.

#include <rayloom/shaders/scene_view.h>

#include <vector>

namespace rayloom::shaders {

/// Parameters of the light callables. In: `position` and the random numbers, each in [0, 1). Out: the rest.
struct LightSample {
  float3 position;   ///< world space, of the shading point
  float choice;      ///< among the lights of one kind
  float2 u;          ///< on the light
  float3 to_light;   ///< the light point minus `position`, kept clear of the light's own surface; or a unit direction
  float t_max;       ///< end of the shadow ray along to_light: 1, or infinity for lights at infinity
  float3 direction;  ///< unit, along to_light
  float pdf;         ///< per steradian, among lights of the kind; of the choice alone when `delta`; 0: no light
  float3 radiance;   ///< arriving, unless something is in the way; for a delta light its irradiance across the ray
  uint32_t delta;    ///< the light is a point or a direction: no BSDF sample can find it
};

void sample_environment_light(const EnvironmentView& view, LightSample& sample);
void sample_triangle_light(const SceneView& view, LightSample& sample);
void sample_punctual_light(const LightView& view, LightSample& sample);

/// Density with which sample_triangle_light finds the point of light `light` that lies at `distance` from the shading
/// point, seen at `cosine` to the light's normal.
float triangle_light_pdf(const LightView& view, uint32_t light, float distance, float cosine);

/// The light that triangle `primitive` of an instance's geometry is, or no_light.
uint32_t find_triangle_light(const LightView& view, uint32_t instance, uint32_t geometry, uint32_t primitive);

/// Host side.
struct LightTables {
  std::vector<TriangleLight> triangles;
  std::vector<float> triangle_table;
  std::vector<uint32_t> emissive_geometries;  ///< flat geometry numbers (mesh order), in order of first use
  std::vector<uint32_t> instance_emitters, geometry_lights;
  std::vector<PunctualLight> punctual;
  std::vector<float> punctual_table;
};

/// Emissive triangles in order of (instance, geometry, primitive), chosen in proportion to luminance times area; a
/// texture counts as white here. Punctual lights in proportion to what they send at `scene_radius`.
LightTables make_light_tables(const scenes::Scene& scene, float scene_radius);

}  // namespace rayloom::shaders
