#pragma once

// Small scenes made in tests.

#include <rayloom/scenes/scene.h>

#include <initializer_list>

namespace rayloom::test {

/// One white rough dielectric material and nothing else.
inline scenes::Scene empty_scene() {
  scenes::Scene scene;
  scene.name = "test scene";
  scene.materials.resize(1);
  scene.materials[0].metallic = 0;
  return scene;
}

/// Two triangles whose front normal is cross(u, v).
inline scenes::Geometry quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v, uint32_t material = 0) {
  scenes::Geometry geometry;
  geometry.material = material;
  geometry.positions = {corner, corner + u, corner + u + v, corner + v};
  geometry.indices = {0, 1, 2, 0, 2, 3};
  geometry.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return geometry;
}

/// An axis-aligned box, faces outward, every face with vertices of its own.
inline scenes::Geometry box(glm::vec3 low, glm::vec3 high, uint32_t material = 0) {
  const glm::vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  scenes::Geometry all;
  all.material = material;
  for (const scenes::Geometry& face : {quad(low, z, y), quad(low + x, y, z), quad(low, x, z), quad(low + y, z, x),
                                       quad(low, y, x), quad(low + z, x, y)}) {
    const auto base = static_cast<uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), face.positions.begin(), face.positions.end());
    all.uv0.insert(all.uv0.end(), face.uv0.begin(), face.uv0.end());
    for (const uint32_t i : face.indices) all.indices.push_back(base + i);
  }
  return all;
}

/// A mesh of one geometry with one instance at the origin. Returns the mesh's number.
inline uint32_t add_mesh(scenes::Scene& scene, scenes::Geometry geometry) {
  scene.meshes.emplace_back();
  scene.meshes.back().geometries.push_back(std::move(geometry));
  scene.instances.emplace_back();
  scene.instances.back().mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
  return scene.instances.back().mesh;
}

inline uint32_t add_spheres(scenes::Scene& scene, std::initializer_list<scenes::Sphere> spheres,
                            uint32_t material = 0) {
  scene.meshes.emplace_back();
  scene.meshes.back().sphere_sets.push_back({"spheres", material, spheres});
  scene.instances.emplace_back();
  scene.instances.back().mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
  return scene.instances.back().mesh;
}

inline scenes::Environment constant_sky(float radiance) {
  scenes::Environment sky;
  sky.kind = scenes::Environment::Kind::constant;
  sky.zenith = sky.horizon = sky.nadir = glm::vec3(radiance);
  return sky;
}

}  // namespace rayloom::test
