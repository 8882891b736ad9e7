#include <rayloom/tools/scene_structures.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

uint32_t geometry_flags(const scenes::Scene& scene, uint32_t material) {
  const bool opaque = scene.materials[material].alpha_mode == scenes::AlphaMode::opaque;
  return opaque ? accel::geometry_flag::opaque : accel::geometry_flag::none;
}

accel::TriangleGeometry triangles(const scenes::Scene& scene, const scenes::Geometry& geometry) {
  accel::TriangleGeometry result;
  result.vertices = reinterpret_cast<const std::byte*>(geometry.positions.data());
  result.vertex_stride = sizeof(glm::vec3);
  result.vertex_count = static_cast<uint32_t>(geometry.positions.size());
  result.indices = reinterpret_cast<const std::byte*>(geometry.indices.data());
  result.index_format = accel::IndexFormat::uint32;
  result.triangle_count = static_cast<uint32_t>(geometry.triangle_count());
  result.flags = geometry_flags(scene, geometry.material);
  return result;
}

/// The sphere's box, a step outward so that rounding cannot cut its skin.
std::array<float, 6> sphere_box(const scenes::Sphere& sphere) {
  std::array<float, 6> box{};
  for (int axis = 0; axis < 3; ++axis) {
    box[static_cast<size_t>(axis)] = std::nextafter(sphere.center[axis] - sphere.radius, -INFINITY);
    box[static_cast<size_t>(axis) + 3] = std::nextafter(sphere.center[axis] + sphere.radius, INFINITY);
  }
  return box;
}

accel::InstanceDesc describe(const scenes::Instance& instance, uint32_t index, const std::byte* bottom_level) {
  accel::InstanceDesc desc{};
  std::memcpy(desc.transform, instance.transform.data(), sizeof desc.transform);
  desc.instance_id = index & 0xFFFFFFu;
  desc.instance_mask = 0xFF;
  desc.bottom_level_address = reinterpret_cast<uint64_t>(bottom_level);
  return desc;
}

}  // namespace

SceneStructures::SceneStructures(const scenes::Scene& scene, const accel::BuildSettings& settings) {
  for (const scenes::Mesh& mesh : scene.meshes) build_mesh(scene, mesh, settings);
  build_instances(scene, settings);
}

template <class Build>
void SceneStructures::build(const std::string& name, uint64_t result_bytes, Build&& run) {
  const auto alignment = std::align_val_t{accel::structure_alignment};
  Block block(static_cast<std::byte*>(::operator new[](result_bytes, alignment)));
  const auto begin = std::chrono::steady_clock::now();
  run(std::span(block.get(), result_bytes));
  const auto time = std::chrono::steady_clock::now() - begin;
  structures_.push_back({name, accel::structure_info(block.get()), result_bytes,
                         static_cast<uint64_t>(std::chrono::nanoseconds(time).count())});
  blocks_.push_back(std::move(block));
}

void SceneStructures::build_mesh(const scenes::Scene& scene, const scenes::Mesh& mesh,
                                 const accel::BuildSettings& settings) {
  const std::string name = mesh.name.empty() ? fmt::format("mesh {}", structures_.size()) : mesh.name;
  const auto build_all = [&](const auto& geometries) {
    const std::span inputs(geometries);
    build(name, accel::bottom_level_sizes(inputs, settings).result_bytes,
          [&](std::span<std::byte> result) { accel::build_bottom_level(inputs, settings, result); });
  };
  if (!mesh.procedural()) {
    std::vector<accel::TriangleGeometry> geometries;
    for (const scenes::Geometry& geometry : mesh.geometries) geometries.push_back(triangles(scene, geometry));
    return build_all(std::as_const(geometries));
  }
  std::vector<std::vector<std::array<float, 6>>> boxes;
  std::vector<accel::AabbGeometry> geometries;
  for (const scenes::SphereSet& set : mesh.sphere_sets) {
    auto& list = boxes.emplace_back();
    for (const scenes::Sphere& sphere : set.spheres) list.push_back(sphere_box(sphere));
    geometries.push_back(
        {reinterpret_cast<const std::byte*>(list.data()), 24, list.size(), geometry_flags(scene, set.material)});
  }
  build_all(std::as_const(geometries));
}

void SceneStructures::build_instances(const scenes::Scene& scene, const accel::BuildSettings& settings) {
  std::vector<accel::InstanceDesc> descs;
  for (const scenes::Instance& instance : scene.instances) {
    descs.push_back(describe(instance, static_cast<uint32_t>(descs.size()), blocks_[instance.mesh].get()));
  }
  build("instances", accel::top_level_sizes(descs.size(), settings).result_bytes,
        [&](std::span<std::byte> result) { accel::build_top_level(descs, accel::AddressSpace{}, settings, result); });
}

}  // namespace rayloom::tools
