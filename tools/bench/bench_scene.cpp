#include <rayloom/tools/bench/bench_scene.h>

#include <rayloom/base/error.h>
#include <rayloom/scenes/camera.h>
#include <rayloom/scenes/procedural/registry.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

glm::vec3 apply(const scenes::Transform3x4& m, glm::vec3 p) {
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

void append(BenchMesh& mesh, const scenes::Geometry& geometry, const scenes::Transform3x4& transform) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size() / 3);
  for (const glm::vec3& position : geometry.positions) {
    const glm::vec3 world = apply(transform, position);
    mesh.vertices.insert(mesh.vertices.end(), {world.x, world.y, world.z});
  }
  for (const uint32_t index : geometry.indices) mesh.indices.push_back(first + index);
}

void finish(BenchMesh& mesh) { mesh.vertices.resize(mesh.vertices.size() + BenchMesh::slack_floats); }

uint64_t triangles_of(const scenes::Mesh& mesh) {
  uint64_t count = 0;
  for (const scenes::Geometry& geometry : mesh.geometries) count += geometry.triangle_count();
  return count;
}

BenchMesh flat_mesh(const scenes::Scene& scene) {
  BenchMesh mesh;
  for (const scenes::Instance& instance : scene.instances) {
    for (const auto& geometry : scene.meshes[instance.mesh].geometries) append(mesh, geometry, instance.transform);
  }
  finish(mesh);
  return mesh;
}

/// Meshes without triangles (spheres) and their instances are left out.
void keep_instances(BenchScene& result, const scenes::Scene& scene) {
  std::vector<uint32_t> new_index(scene.meshes.size());
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    new_index[i] = static_cast<uint32_t>(result.meshes.size());
    if (triangles_of(scene.meshes[i]) == 0) continue;
    BenchMesh& mesh = result.meshes.emplace_back();
    for (const auto& geometry : scene.meshes[i].geometries) append(mesh, geometry, scenes::identity_transform);
    finish(mesh);
  }
  for (const scenes::Instance& instance : scene.instances) {
    if (triangles_of(scene.meshes[instance.mesh]))
      result.instances.push_back({new_index[instance.mesh], instance.transform});
  }
}

std::optional<std::string> find_scene(const std::string& name, const std::string& directory) {
  if (scenes::is_procedural_name(name) || std::filesystem::is_regular_file(name)) return name;
  if (directory.empty()) return std::nullopt;
  for (const char* extension : {"", ".glb", ".gltf"}) {
    const std::filesystem::path path = std::filesystem::path(directory) / (name + extension);
    if (std::filesystem::is_regular_file(path)) return path.string();
  }
  return std::nullopt;
}

}  // namespace

uint64_t BenchScene::stored_triangles() const {
  uint64_t count = 0;
  for (const BenchMesh& mesh : meshes) count += mesh.triangle_count();
  return count;
}

uint64_t BenchScene::effective_triangles() const {
  if (!two_level()) return stored_triangles();
  uint64_t count = 0;
  for (const PeerInstance& instance : instances) count += meshes[instance.mesh].triangle_count();
  return count;
}

PeerScene BenchScene::peer() const {
  PeerScene scene;
  for (const BenchMesh& mesh : meshes) scene.meshes.push_back(mesh.peer());
  scene.instances = instances;
  return scene;
}

std::array<glm::vec3, 3> BenchScene::triangle(uint32_t instance, uint32_t primitive) const {
  const BenchMesh& mesh = meshes[two_level() ? instances[instance].mesh : 0];
  std::array<glm::vec3, 3> corners;
  for (size_t i = 0; i < 3; ++i) {
    const float* p = &mesh.vertices[size_t{mesh.indices[size_t{primitive} * 3 + i]} * 3];
    corners[i] = {p[0], p[1], p[2]};
    if (two_level()) corners[i] = apply(instances[instance].transform, corners[i]);
  }
  return corners;
}

bool bench_scene_exists(const std::string& name, const std::string& directory) {
  return find_scene(name, directory).has_value();
}

BenchScene load_bench_scene(const std::string& name, const std::string& directory, uint64_t largest_flat) {
  // A name that is found nowhere is explained by load_scene.
  const scenes::Scene scene = scenes::load_scene(find_scene(name, directory).value_or(name));
  uint64_t triangles = 0;
  for (const scenes::Instance& instance : scene.instances) triangles += triangles_of(scene.meshes[instance.mesh]);
  if (triangles == 0) throw InputError(name, "", "has no triangles to measure");
  BenchScene result{name, {}, {}, scenes::choose_camera(scene, "", 1), scenes::world_bounds(scene)};
  if (triangles > largest_flat) {
    keep_instances(result, scene);
  } else {
    result.meshes.push_back(flat_mesh(scene));
  }
  return result;
}

std::string default_scenes_directory() {
  const char* directory = std::getenv("RAYLOOM_SHARED_SCENES");
  return directory ? directory : "";
}

}  // namespace rayloom::bench
