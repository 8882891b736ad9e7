#include "scene.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/gltf/load_gltf.h>
#include <rayloom/scenes/procedural/registry.h>

#include <cmath>
#include <filesystem>

namespace rayloom::scenes {
namespace {

glm::vec3 transformed(const Transform3x4& m, glm::vec3 p) {
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

/// Half the side of the box around a transformed unit sphere, on each axis: the lengths of the matrix's rows.
glm::vec3 sphere_extent(const Transform3x4& m) {
  const auto row = [&](size_t i) { return std::sqrt(m[i] * m[i] + m[i + 1] * m[i + 1] + m[i + 2] * m[i + 2]); };
  return {row(0), row(4), row(8)};
}

void add_instance(const Mesh& mesh, const Transform3x4& transform, Bounds& bounds) {
  for (const Geometry& geometry : mesh.geometries) {
    for (const glm::vec3& position : geometry.positions) bounds.add(transformed(transform, position));
  }
  const glm::vec3 extent = sphere_extent(transform);
  for (const SphereSet& set : mesh.sphere_sets) {
    for (const Sphere& sphere : set.spheres) {
      const glm::vec3 center = transformed(transform, sphere.center);
      bounds.add(center - sphere.radius * extent);
      bounds.add(center + sphere.radius * extent);
    }
  }
}

}  // namespace

Bounds world_bounds(const Scene& scene) {
  Bounds bounds;
  for (const Instance& instance : scene.instances) {
    add_instance(scene.meshes[instance.mesh], instance.transform, bounds);
  }
  return bounds;
}

Scene load_scene(const std::string& file_or_name) {
  if (is_procedural_name(file_or_name)) return make_procedural_scene(file_or_name);
  std::error_code error;
  if (std::filesystem::exists(file_or_name, error)) return load_gltf(file_or_name);
  throw InputError(file_or_name, "", "no such file, and no procedural scene; those are " + procedural_scene_names());
}

}  // namespace rayloom::scenes
