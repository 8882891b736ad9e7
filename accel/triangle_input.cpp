#include <rayloom/accel/checks.h>
#include <rayloom/accel/collect_refs.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/error.h>

#include <cmath>
#include <cstring>
#include <string>

namespace rayloom::accel {
namespace {

bool same_point(const float (&a)[3], const float (&b)[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

bool has_equal_vertices(const InputTriangle& corners) {
  const auto& v = corners.vertex;
  return same_point(v[0], v[1]) || same_point(v[1], v[2]) || same_point(v[2], v[0]);
}

}  // namespace

bool is_active(const InputTriangle& corners) {
  for (const auto& vertex : corners.vertex)
    for (const float x : vertex)
      if (!std::isfinite(x)) return false;
  return true;
}

void detail::throw_index_error(const TriangleGeometry& geometry, uint32_t geometry_index, uint32_t triangle,
                               const Indices& indices) {
  for (const uint32_t index : indices)
    if (index >= geometry.vertex_count)
      throw InputError("acceleration structure build",
                       "geometries[" + std::to_string(geometry_index) + "]: triangle " + std::to_string(triangle),
                       "index " + std::to_string(index) + " is out of range, the geometry has " +
                           std::to_string(geometry.vertex_count) + " vertices (BI-14)");
}

InputTriangle read_checked_triangle(const TriangleGeometry& geometry, uint32_t index, uint32_t triangle) {
  return read_corners(geometry, checked_indices(geometry, index, triangle));
}

PrimitiveRefs triangle_refs(std::span<const TriangleGeometry> geometries, bool keep_degenerate) {
  PrimitiveRefs refs;
  refs.reserve(checked_count(geometries));
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    const TriangleGeometry& geometry = geometries[g];
    append_refs(refs, geometry.triangle_count, [&](uint32_t triangle) -> std::optional<PrimitiveRef> {
      const InputTriangle corners = read_corners(geometry, checked_indices(geometry, g, triangle));
      if (!is_active(corners) || (has_equal_vertices(corners) && !keep_degenerate)) return std::nullopt;
      Box box;
      for (const auto& vertex : corners.vertex) box.extend(vertex);
      return make_primitive_ref(box, g, triangle);
    });
  }
  return refs;
}

}  // namespace rayloom::accel
