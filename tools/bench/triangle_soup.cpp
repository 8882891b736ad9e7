#include "triangle_soup.h"

#include <rayloom/scenes/scene.h>

#include <new>
#include <sys/mman.h>

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

/// Memory in huge pages where the system has them, as the peer's own allocator and the runtime's Device ask for.
std::byte* map_huge(uint64_t bytes) {
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  madvise(memory, bytes, MADV_HUGEPAGE);
  return static_cast<std::byte*>(memory);
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
  mapped_ = accel::bottom_level_sizes(geometries, 0).result_bytes;
  block_ = map_huge(mapped_);
  bytes_ = accel::build_bottom_level(geometries, 0, {block_, mapped_});
}

Structure::~Structure() { munmap(block_, mapped_); }

}  // namespace rayloom::bench
