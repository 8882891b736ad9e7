// Host side of lights.h: gathers a scene's lights and the tables they are chosen by.

#include <rayloom/accel/instance_transform.h>
#include <rayloom/base/error.h>
#include <rayloom/shaders/distribution.h>
#include <rayloom/shaders/lights.h>
#include <rayloom/shaders/spawn.h>

#include <cmath>
#include <cstring>
#include <map>

namespace rayloom::shaders {
namespace {

struct WorldTransform {
  double matrix[3][4];
  bool active;  ///< instances without an inverse are never hit (TL-08), so they give no light

  explicit WorldTransform(const scenes::Transform3x4& transform) {
    float rows[3][4];
    std::memcpy(rows, transform.data(), sizeof(rows));
    active = accel::invert(rows).has_value();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) matrix[r][c] = rows[r][c];
  }
  double3 point(double3 p) const { return vector(p) + double3(matrix[0][3], matrix[1][3], matrix[2][3]); }
  double3 vector(double3 v) const {
    double3 out;
    for (int r = 0; r < 3; ++r) out[r] = matrix[r][0] * v.x + matrix[r][1] * v.y + matrix[r][2] * v.z;
    return out;
  }
  /// The largest world-space change that changing a point by up to `magnitude` an axis makes.
  double3 spread(double3 magnitude) const {
    double3 out;
    for (int r = 0; r < 3; ++r)
      out[r] = std::fabs(matrix[r][0]) * magnitude.x + std::fabs(matrix[r][1]) * magnitude.y +
               std::fabs(matrix[r][2]) * magnitude.z;
    return out;
  }
  bool mirrors() const {
    const double3 x(matrix[0][0], matrix[1][0], matrix[2][0]), y(matrix[0][1], matrix[1][1], matrix[2][1]),
        z(matrix[0][2], matrix[1][2], matrix[2][2]);
    return glm::dot(glm::cross(x, y), z) < 0;
  }
};

class TriangleLightCollector {
 public:
  TriangleLightCollector(const scenes::Scene& scene, LightTables& tables) : scene_(scene), tables_(tables) {}

  void collect() {
    uint32_t flat = 0;
    for (const scenes::Mesh& mesh : scene_.meshes) {
      first_geometry_.push_back(flat);
      flat += static_cast<uint32_t>(mesh.geometries.size());
    }
    for (const scenes::Instance& instance : scene_.instances) add_instance(instance);
    if (tables_.triangles.empty()) return;
    append_cumulative(weights_, tables_.triangle_table);
    for (size_t i = 0; i < weights_.size(); ++i)
      tables_.triangles[i].density *= tables_.triangle_table[i + 1] - tables_.triangle_table[i];
  }

 private:
  bool emits(const scenes::Geometry& geometry) const { return scene_.materials.at(geometry.material).emits(); }

  void add_instance(const scenes::Instance& instance) {
    const scenes::Mesh& mesh = scene_.meshes.at(instance.mesh);
    const WorldTransform transform(instance.transform);
    bool any = false;
    for (const scenes::Geometry& geometry : mesh.geometries) any = any || emits(geometry);
    tables_.instance_emitters.push_back(any && transform.active ? static_cast<uint32_t>(tables_.geometry_lights.size())
                                                                : no_light);
    if (tables_.instance_emitters.back() == no_light) return;
    for (uint32_t g = 0; g < mesh.geometries.size(); ++g) {
      const bool lit = emits(mesh.geometries[g]);
      tables_.geometry_lights.push_back(lit ? static_cast<uint32_t>(tables_.triangles.size()) : no_light);
      if (lit) add_geometry(mesh.geometries[g], first_geometry_[instance.mesh] + g, transform);
    }
  }

  uint32_t record_number(uint32_t flat_geometry) {
    const auto next = static_cast<uint32_t>(tables_.emissive_geometries.size());
    const auto [entry, added] = record_numbers_.try_emplace(flat_geometry, next);
    if (added) tables_.emissive_geometries.push_back(flat_geometry);
    return entry->second;
  }

  void add_geometry(const scenes::Geometry& geometry, uint32_t flat_geometry, const WorldTransform& transform) {
    const scenes::Material& material = scene_.materials.at(geometry.material);
    const float power = luminance(material.emissive) * (material.double_sided ? 2.0f : 1.0f);
    const uint32_t record = record_number(flat_geometry);
    if (tables_.triangles.size() + geometry.triangle_count() > max_lights)
      throw InputError(scene_.name, "emissive triangles", "there are more than 8,388,608 of them");
    for (uint32_t i = 0; i < geometry.triangle_count(); ++i) {
      const TriangleLight light = make_light(geometry, i, record, transform);
      tables_.triangles.push_back(light);
      weights_.push_back(light.density > 0 ? power / light.density : 0.0f);
    }
  }

  /// `density` is one over the area, 0 for a degenerate triangle.
  static TriangleLight make_light(const scenes::Geometry& geometry, uint32_t i, uint32_t record,
                                  const WorldTransform& transform) {
    const double3 p0(geometry.positions[geometry.indices[3 * i]]), p1(geometry.positions[geometry.indices[3 * i + 1]]),
        p2(geometry.positions[geometry.indices[3 * i + 2]]);
    const double3 vertex = transform.point(p0), edge1 = transform.vector(p1 - p0), edge2 = transform.vector(p2 - p0);
    const double3 cross = glm::cross(edge1, edge2) * (transform.mirrors() ? -1.0 : 1.0);
    const double doubled_area = glm::length(cross);
    const double3 normal = doubled_area > 0 ? cross / doubled_area : double3(0);
    const double3 reach = glm::abs(vertex) + glm::abs(edge1) + glm::abs(edge2);
    const double3 object_reach = glm::max(glm::abs(p0), glm::max(glm::abs(p1), glm::abs(p2)));
    TriangleLight light;
    light.vertex = float3(vertex), light.edge1 = float3(edge1), light.edge2 = float3(edge2);
    light.normal = float3(normal);
    light.material = geometry.material, light.geometry = record, light.primitive = i;
    light.error = static_cast<float>(0x1p-22 * glm::dot(glm::abs(normal), reach + transform.spread(object_reach)));
    const double density = doubled_area > 0 ? 2 / doubled_area : 0;
    light.density = density < 1e30 ? static_cast<float>(density) : 0.0f;
    return light;
  }

  static constexpr uint64_t max_lights = uint64_t{1} << 23;
  const scenes::Scene& scene_;
  LightTables& tables_;
  std::vector<uint32_t> first_geometry_;
  std::map<uint32_t, uint32_t> record_numbers_;
  std::vector<float> weights_;
};

float punctual_power(const scenes::Light& light, float scene_radius) {
  const float strength = luminance(light.intensity);
  switch (light.kind) {
    case scenes::Light::Kind::point:
      return 4 * pi * strength;
    case scenes::Light::Kind::spot:
      return 2 * pi * (1 - light.cos_outer_cone) * strength;
    case scenes::Light::Kind::directional:
      return pi * scene_radius * scene_radius * strength;
  }
  return 0;
}

void collect_punctual(const scenes::Scene& scene, float scene_radius, LightTables& tables) {
  std::vector<float> weights;
  for (const scenes::Light& light : scene.lights) {
    const float power = punctual_power(light, scene_radius);
    if (!(power > 0)) continue;
    weights.push_back(std::fmin(power, 1e30f));
    tables.punctual.push_back({light.position, static_cast<uint32_t>(light.kind), light.direction, light.range,
                               light.intensity, light.cos_inner_cone, light.cos_outer_cone});
  }
  if (!weights.empty()) append_cumulative(weights, tables.punctual_table);
}

}  // namespace

LightTables make_light_tables(const scenes::Scene& scene, float scene_radius) {
  LightTables tables;
  TriangleLightCollector(scene, tables).collect();
  collect_punctual(scene, scene_radius, tables);
  return tables;
}

}  // namespace rayloom::shaders
