#pragma once

// What shaders see of a scene: plain structs in device memory. Filled by scene_to_device.

#include <rayloom/runtime/buffer_views.h>
#include <rayloom/scenes/scene.h>
#include <rayloom/shaders/vector_math.h>

namespace rayloom::shaders {

class TextureTable;

/// Local root arguments of a triangle geometry's hit records. Addresses of absent attributes are 0.
struct TriangleRecord {
  uint64_t positions = 0, indices = 0, normals = 0, tangents = 0, uv0 = 0, uv1 = 0, colors = 0;
  uint32_t vertex_count = 0, index_count = 0;
  uint32_t material = 0;
  uint32_t reserved = 0;
};

/// Local root arguments of a sphere set's hit records.
struct SphereRecord {
  StructuredBuffer<scenes::Sphere> spheres;
  uint32_t material = 0;
  uint32_t reserved = 0;
};

namespace material_flag {
inline constexpr uint32_t double_sided = 0x1;
inline constexpr uint32_t mask = 0x2;
inline constexpr uint32_t blend = 0x4;
inline constexpr uint32_t first_texture = 0x10;  ///< shifted left by a TextureSlot
}  // namespace material_flag

enum class TextureSlot : uint32_t { base_color, metallic_roughness, normal, occlusion, emissive };
inline constexpr uint32_t texture_slots = 5;

/// The part of a material every hit reads. Its texture references lie apart, texture_slots a material.
struct MaterialCore {
  float4 base_color{1};
  float3 emissive{0};
  float metallic = 1;
  float roughness = 1;
  float normal_scale = 1;
  float alpha_cutoff = 0.5f;
  uint32_t flags = 0;

  bool has(TextureSlot slot) const {
    return (flags & (material_flag::first_texture << static_cast<uint32_t>(slot))) != 0;
  }
  bool emits() const { return largest_component(emissive) > 0; }
};
static_assert(sizeof(MaterialCore) == 48);

struct MaterialView {
  StructuredBuffer<MaterialCore> cores;
  StructuredBuffer<scenes::TextureRef> texture_refs;
  const TextureTable* textures = nullptr;
};

/// An emissive triangle in world space.
struct TriangleLight {
  float3 vertex;
  float density;  ///< probability of being chosen per area
  float3 edge1;
  uint32_t material;
  float3 edge2;
  uint32_t geometry;  ///< of LightView::geometries
  float3 normal;      ///< unit, on the front side
  uint32_t primitive;
  float error;  ///< bounds how far, along the normal, points computed here lie off the triangle rays meet
};

struct PunctualLight {
  float3 position;
  uint32_t kind;  ///< scenes::Light::Kind
  float3 direction;
  float range;
  float3 intensity;
  float cos_inner_cone;
  float cos_outer_cone;
};

inline constexpr uint32_t no_light = ~0u;

/// Cumulative tables as distribution.h makes them, one entry longer than what they choose from.
struct LightView {
  StructuredBuffer<TriangleLight> triangles;
  StructuredBuffer<float> triangle_table;
  StructuredBuffer<TriangleRecord> geometries;   ///< those with emissive materials
  StructuredBuffer<uint32_t> instance_emitters;  ///< an instance's first entry in geometry_lights, or no_light
  StructuredBuffer<uint32_t> geometry_lights;    ///< the light of a geometry's triangle 0, or no_light
  StructuredBuffer<PunctualLight> punctual;
  StructuredBuffer<float> punctual_table;
};

/// The sky. `rows` x `columns` cells for sampling; their edges are equally spaced in latitude and longitude.
struct EnvironmentView {
  scenes::Environment::Kind kind = scenes::Environment::Kind::none;
  float3 zenith{0}, horizon{0}, nadir{0};
  StructuredBuffer<float3> texels;  ///< image: rows x columns, row 0 up
  StructuredBuffer<float> table;    ///< over rows; then, a row, over its columns
  uint32_t rows = 0, columns = 0;
};

struct SceneView {
  RaytracingAccelerationStructure structure;
  uint32_t ray_types = 1;  ///< hit records a geometry: 2 when shadow rays need shaders of their own
  MaterialView materials;
  LightView lights;
  EnvironmentView environment;

  bool has_environment() const { return environment.kind != scenes::Environment::Kind::none; }
  bool has_triangle_lights() const { return lights.triangles.count > 0; }
  bool has_punctual_lights() const { return lights.punctual.count > 0; }
  uint32_t light_kinds() const {
    return uint32_t{has_environment()} + uint32_t{has_triangle_lights()} + uint32_t{has_punctual_lights()};
  }
};

}  // namespace rayloom::shaders
