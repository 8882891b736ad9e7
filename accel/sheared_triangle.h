#pragma once

// The second of three evaluations of a hit (simd/lanes: float, here: double, exact_triangle.h: integers). Without fused
// operations, so that it is fast and equal on every CPU.

#include <rayloom/accel/prepared_ray.h>

#include <algorithm>
#include <cmath>

namespace rayloom::accel {

/// The nine coordinates of a triangle, by vertex.
struct TriangleCorners {
  const float* vertex[3];
};

inline constexpr double double_unit = 0x1p-53;  // half the distance from 1 to the next double

/// The triangle in the ray's sheared frame, in double. docs/numerics.md, "The double filter", bounds every edge
/// function's error by `bound`, which is finite exactly when every coordinate is.
struct ShearedTriangle {
  double edge[3];             ///< E01, E12, E20
  bool exactly_zero[3] = {};  ///< known from the exact evaluation
  double z[3];
  double bound;
};

inline ShearedTriangle shear_triangle(const PreparedRay& ray, const TriangleCorners& corners) {
  ShearedTriangle out;
  double x[3], y[3];
  for (int i = 0; i < 3; ++i) {
    const float* vertex = corners.vertex[i];
    const auto [kx, ky, kz] = ray.axis;
    out.z[i] = double{vertex[kz]} - double{ray.origin[kz]};
    x[i] = (double{vertex[kx]} - double{ray.origin[kx]}) - ray.shear_double[0] * out.z[i];
    y[i] = (double{vertex[ky]} - double{ray.origin[ky]}) - ray.shear_double[1] * out.z[i];
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    out.edge[i] = x[i] * y[j] - y[i] * x[j];
  }
  const double extent =
      std::fabs(x[0]) + std::fabs(y[0]) + std::fabs(x[1]) + std::fabs(y[1]) + std::fabs(x[2]) + std::fabs(y[2]);
  const double depth = std::max({std::fabs(out.z[0]), std::fabs(out.z[1]), std::fabs(out.z[2])});
  out.bound = double_unit * ((extent + 0x1p-49 * depth) * (1.625 * extent + 5.25 * depth));
  return out;
}

}  // namespace rayloom::accel
