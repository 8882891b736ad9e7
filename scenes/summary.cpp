#include "summary.h"

namespace rayloom::scenes {
namespace {

template <typename T>
uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

uint64_t geometry_bytes(const Geometry& g) {
  return bytes_of(g.positions) + bytes_of(g.indices) + bytes_of(g.normals) + bytes_of(g.tangents) + bytes_of(g.uv0) +
         bytes_of(g.uv1) + bytes_of(g.colors);
}

uint64_t triangles_of(const Mesh& mesh) {
  uint64_t count = 0;
  for (const Geometry& geometry : mesh.geometries) count += geometry.triangle_count();
  return count;
}

uint64_t spheres_of(const Mesh& mesh) {
  uint64_t count = 0;
  for (const SphereSet& set : mesh.sphere_sets) count += set.spheres.size();
  return count;
}

void add_meshes(const Scene& scene, SceneSummary& summary) {
  summary.meshes = scene.meshes.size();
  for (const Mesh& mesh : scene.meshes) {
    summary.geometries += mesh.geometries.size() + mesh.sphere_sets.size();
    summary.triangles += triangles_of(mesh);
    summary.spheres += spheres_of(mesh);
    for (const Geometry& geometry : mesh.geometries) {
      summary.vertices += geometry.positions.size();
      summary.geometry_bytes += geometry_bytes(geometry);
    }
    for (const SphereSet& set : mesh.sphere_sets) summary.geometry_bytes += bytes_of(set.spheres);
  }
  summary.instances = scene.instances.size();
  for (const Instance& instance : scene.instances) {
    summary.instanced_triangles += triangles_of(scene.meshes[instance.mesh]);
    summary.instanced_spheres += spheres_of(scene.meshes[instance.mesh]);
  }
}

void add_materials(const Scene& scene, SceneSummary& summary) {
  summary.materials = scene.materials.size();
  for (const Material& material : scene.materials) {
    summary.masked_materials += material.alpha_mode == AlphaMode::mask;
    summary.blended_materials += material.alpha_mode == AlphaMode::blend;
    summary.emissive_materials += material.emits();
  }
  summary.textures = scene.textures.size();
  summary.images = scene.images.size();
  for (const auto& image : scene.images) {
    summary.images_decoded += image->decoded();
    summary.image_bytes += image->memory_bytes();
  }
}

void add_lights_and_cameras(const Scene& scene, SceneSummary& summary) {
  for (const Light& light : scene.lights) {
    summary.point_lights += light.kind == Light::Kind::point;
    summary.spot_lights += light.kind == Light::Kind::spot;
    summary.directional_lights += light.kind == Light::Kind::directional;
  }
  for (const SceneCamera& camera : scene.cameras) {
    summary.perspective_cameras += camera.kind == SceneCamera::Kind::perspective;
    summary.orthographic_cameras += camera.kind == SceneCamera::Kind::orthographic;
  }
}

}  // namespace

SceneSummary summarize(const Scene& scene) {
  SceneSummary summary;
  summary.name = scene.name;
  add_meshes(scene, summary);
  add_materials(scene, summary);
  add_lights_and_cameras(scene, summary);
  summary.bounds = world_bounds(scene);
  summary.extensions_used = scene.extensions_used;
  summary.warnings = scene.warnings;
  return summary;
}

}  // namespace rayloom::scenes
