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

Bounds object_bounds(const Mesh& mesh) {
  Bounds bounds;
  for (const Geometry& geometry : mesh.geometries) {
    for (const glm::vec3& position : geometry.positions) bounds.add(position);
  }
  return bounds;
}

/// Whether no point of `object`, transformed in floats with all its roundings, can enlarge `world`.
bool surely_inside(const Bounds& object, const Transform3x4& m, const Bounds& world) {
  if (object.empty() || world.empty()) return false;
  const glm::dvec3 low(object.min), high(object.max), center = 0.5 * (low + high), half = 0.5 * (high - low);
  for (int axis = 0; axis < 3; ++axis) {
    const float* row = &m[4 * static_cast<size_t>(axis)];
    double middle = row[3], reach = 0, terms = std::fabs(row[3]);
    for (int k = 0; k < 3; ++k) {
      middle += static_cast<double>(row[k]) * center[k];
      reach += std::fabs(row[k]) * half[k];
      terms += std::fabs(row[k]) * (std::fabs(center[k]) + half[k]);
    }
    reach += 1e-6 * terms;  // six roundings of 6e-8
    if (!(middle - reach > world.min[axis] && middle + reach < world.max[axis])) return false;
  }
  return true;
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
  std::vector<Bounds> objects;  // so that most of a forest's trees need not be looked at leaf by leaf
  for (const Mesh& mesh : scene.meshes) objects.push_back(object_bounds(mesh));
  Bounds bounds;
  for (const Instance& instance : scene.instances) {
    if (surely_inside(objects[instance.mesh], instance.transform, bounds)) continue;
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
