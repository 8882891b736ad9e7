#pragma once

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/primitive_ref.h>
#include <rayloom/accel/read_triangle.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace rayloom::accel {

namespace detail {
void throw_index_error(const TriangleGeometry& geometry, uint32_t geometry_index, uint32_t triangle,
                       const Indices& indices);
}

/// A triangle's indices; throws InputError, naming geometry `index`, where one is out of range.
inline Indices checked_indices(const TriangleGeometry& geometry, uint32_t index, uint32_t triangle) {
  const Indices indices = read_indices(geometry, triangle);
  if (std::max({indices[0], indices[1], indices[2]}) >= geometry.vertex_count)
    detail::throw_index_error(geometry, index, triangle, indices);
  return indices;
}

/// read_triangle() for any indices; throws InputError, naming geometry `index`, where one is out of range.
InputTriangle read_checked_triangle(const TriangleGeometry& geometry, uint32_t index, uint32_t triangle);

/// False for triangles with a coordinate that is not finite: PR-01, PR-03, and, by our policy, PR-07 and BI-26.
bool is_active(const InputTriangle& corners);

/// References to the triangles that go into leaves. Left out are
///  - inactive triangles: NaN in the x of any vertex (PR-01, PR-03), and, by our policy for PR-07 and BI-26, NaN or an
///    infinity in any coordinate;
///  - triangles with two equal vertices, which nothing can hit (PR-10), unless `keep_degenerate`.
/// Throws InputError for an index out of range.
PrimitiveRefs triangle_refs(std::span<const TriangleGeometry> geometries, bool keep_degenerate);

}  // namespace rayloom::accel
