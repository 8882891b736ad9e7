#include <rayloom/accel/checks.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/base/error.h>

#include <string>

namespace rayloom::accel {
namespace {

constexpr std::string_view where = "acceleration structure build";

std::string geometry_name(size_t index) { return "geometries[" + std::to_string(index) + "]"; }

void check_limit(uint64_t count, uint64_t limit, const char* what) {
  if (count <= limit) return;
  throw InputError(where, what,
                   std::to_string(count) + " are over the limit of " + std::to_string(limit) + " (CAP-09)");
}

template <class Geometry, class Count>
uint64_t sum_counts(std::span<const Geometry> geometries, const Count& count) {
  check_limit(geometries.size(), max_geometries, "geometries");
  uint64_t sum = 0;
  for (const Geometry& geometry : geometries) {
    check_limit(count(geometry), max_primitives, "primitives");
    sum += count(geometry);
  }
  check_limit(sum, max_primitives, "primitives");
  return sum;
}

void check_geometry(const TriangleGeometry& geometry, size_t index) {
  const auto fail = [&](const std::string& rule) { throw InputError(where, geometry_name(index), rule); };
  if (geometry.triangle_count == 0) return;
  if (!geometry.vertices) fail("has triangles but no vertex buffer");
  if (geometry.index_format > IndexFormat::uint32) fail("unknown index format");
  if (geometry.index_format != IndexFormat::none && !geometry.indices) fail("has an index format but no index buffer");
  const uint64_t needed = 3 * uint64_t{geometry.triangle_count};
  if (geometry.index_format == IndexFormat::none && needed > geometry.vertex_count)
    fail(std::to_string(geometry.triangle_count) + " unindexed triangles need " + std::to_string(needed) +
         " vertices, the geometry has " + std::to_string(geometry.vertex_count) + " (BI-14)");
}

}  // namespace

uint64_t checked_count(std::span<const TriangleGeometry> geometries) {
  return sum_counts(geometries, [](const TriangleGeometry& g) { return uint64_t{g.triangle_count}; });
}

uint64_t checked_count(std::span<const AabbGeometry> geometries) {
  return sum_counts(geometries, [](const AabbGeometry& g) { return g.box_count; });
}

void check_instance_count(uint64_t count) { check_limit(count, max_instances, "instances"); }

void check_geometries(std::span<const TriangleGeometry> geometries) {
  for (size_t i = 0; i < geometries.size(); ++i) check_geometry(geometries[i], i);
}

void check_geometries(std::span<const AabbGeometry> geometries) {
  for (size_t i = 0; i < geometries.size(); ++i)
    if (geometries[i].box_count > 0 && !geometries[i].boxes)
      throw InputError(where, geometry_name(i), "has boxes but no box buffer");
}

void check_result(std::span<const std::byte> result, uint64_t bytes) {
  if (reinterpret_cast<uintptr_t>(result.data()) % structure_alignment != 0)
    throw InputError(where, "result", "memory is not aligned to " + std::to_string(structure_alignment) + " bytes");
  if (result.size() < bytes)
    throw InputError(
        where, "result",
        "memory has " + std::to_string(result.size()) + " bytes, the build needs " + std::to_string(bytes));
}

}  // namespace rayloom::accel
