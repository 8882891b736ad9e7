#include "triangle_soup.h"

#include <rayloom/scenes/scene.h>

namespace rayloom::bench {
namespace {

glm::vec3 apply(const scenes::Transform3x4& m, glm::vec3 p) {
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

void append(TriangleSoup& soup, const scenes::Geometry& geometry, const scenes::Transform3x4& transform) {
  const auto first = static_cast<uint32_t>(soup.vertices.size() / 3);
  for (const glm::vec3& position : geometry.positions) {
    const glm::vec3 world = apply(transform, position);
    soup.vertices.insert(soup.vertices.end(), {world.x, world.y, world.z});
  }
  for (const uint32_t index : geometry.indices) soup.indices.push_back(first + index);
}

std::byte* align(std::byte* pointer, uint64_t alignment) {
  const auto address = reinterpret_cast<uintptr_t>(pointer);
  return pointer + (alignment - address % alignment) % alignment;
}

}  // namespace

TriangleSoup load_soup(const std::string& scene_name) {
  const scenes::Scene scene = scenes::load_scene(scene_name);
  TriangleSoup soup;
  for (const scenes::Instance& instance : scene.instances)
    for (const scenes::Geometry& geometry : scene.meshes[instance.mesh].geometries)
      append(soup, geometry, instance.transform);
  soup.vertices.resize(soup.vertices.size() + 6);
  return soup;
}

Structure::Structure(const TriangleSoup& soup) {
  accel::TriangleGeometry geometry;
  geometry.vertices = reinterpret_cast<const std::byte*>(soup.vertices.data());
  geometry.vertex_count = soup.vertex_count();
  geometry.indices = reinterpret_cast<const std::byte*>(soup.indices.data());
  geometry.index_format = accel::IndexFormat::uint32;
  geometry.triangle_count = soup.triangle_count();
  geometry.flags = accel::geometry_flag::opaque;
  const accel::TriangleGeometry geometries[]{geometry};
  const uint64_t bytes = accel::bottom_level_sizes(geometries, 0).result_bytes;
  memory_.resize(bytes + accel::structure_alignment);
  block_ = align(memory_.data(), accel::structure_alignment);
  bytes_ = accel::build_bottom_level(geometries, 0, {block_, bytes});
}

}  // namespace rayloom::bench
