#pragma once

// Reading a triangle from the caller's buffers, inline for the loops over all of them.

#include <rayloom/accel/build_input.h>

#include <array>
#include <cmath>
#include <cstring>

namespace rayloom::accel {

/// Three corners as the build sees them, the geometry's transform applied.
struct InputTriangle {
  float vertex[3][3];
};

using Indices = std::array<uint32_t, 3>;

template <class Index>
Indices load_indices(const std::byte* indices, uint32_t triangle) {
  Index index[3];
  std::memcpy(index, indices + sizeof(index) * uint64_t{triangle}, sizeof(index));
  return {index[0], index[1], index[2]};
}

inline Indices read_indices(const TriangleGeometry& geometry, uint32_t triangle) {
  if (geometry.index_format == IndexFormat::uint16) return load_indices<uint16_t>(geometry.indices, triangle);
  if (geometry.index_format == IndexFormat::uint32) return load_indices<uint32_t>(geometry.indices, triangle);
  return {3 * triangle, 3 * triangle + 1, 3 * triangle + 2};
}

/// Row by row as one fixed chain of fused multiply-adds, so a shared vertex moves to the same place in each triangle.
inline void apply(const float* transform, float (&p)[3]) {
  const float x = p[0], y = p[1], z = p[2];
  for (int row = 0; row < 3; ++row) {
    const float* m = transform + 4 * row;
    p[row] = std::fma(m[0], x, std::fma(m[1], y, std::fma(m[2], z, m[3])));
  }
}

/// Only the low 32 bits of the stride count (BI-12).
inline const std::byte* address_of_vertex(const TriangleGeometry& geometry, uint32_t index) {
  return geometry.vertices + uint64_t{index} * static_cast<uint32_t>(geometry.vertex_stride);
}

inline void read_vertex(const TriangleGeometry& geometry, uint32_t index, float (&p)[3]) {
  std::memcpy(p, address_of_vertex(geometry, index), sizeof(p));
  if (geometry.transform) apply(geometry.transform, p);
}

inline InputTriangle read_corners(const TriangleGeometry& geometry, const Indices& indices) {
  InputTriangle corners;
  for (int i = 0; i < 3; ++i) read_vertex(geometry, indices[i], corners.vertex[i]);
  return corners;
}

/// Triangle `triangle` of a geometry that check_geometries() accepts, its indices in range.
inline InputTriangle read_triangle(const TriangleGeometry& geometry, uint32_t triangle) {
  return read_corners(geometry, read_indices(geometry, triangle));
}

}  // namespace rayloom::accel
