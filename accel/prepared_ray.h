#pragma once

// What every box and triangle test reads of a ray, computed once per ray and structure. The proofs behind the constants
// are in docs/numerics.md.

#include <rayloom/accel/ray.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace rayloom::accel {

/// A ray made ready for one structure. Plane distances are in *box space*: t times box_scale, a power of two of this
/// ray, so distances of rays prepared for different structures (a world ray and its copy in an instance) must not be
/// compared; convert limits with near_limit() and far_limit().
struct alignas(64) PreparedRay : Ray {
  // Triangles: axis[2] is the axis of the largest direction component (the lowest of equals), axis[0] and axis[1]
  // follow it cyclically; x' = x - shear[0] * z, y' = y - shear[1] * z looks along the ray.
  uint32_t axis[3];
  float ordered_origin[3];  ///< origin[axis[i]]
  float shear[2];           ///< direction[axis[i]] / direction[axis[2]]

  // Boxes: entry = fma(near plane, reciprocal, near_offset), exit = fma(far plane, reciprocal, far_offset), per axis.
  // Finite for every ray, so the infinite planes of empty slots never pass. Fourth elements are there for vector
  // stores.
  float reciprocal[4];
  float near_offset[4], far_offset[4];
  uint32_t near_row[4];  ///< first of the eight floats of the near planes in bounds[axis][side][lane]

  double box_scale;

  bool valid;  ///< false: the ray misses everything (TR-17, TR-18) and the other members mean nothing

  uint32_t far_row(int k) const { return near_row[k] ^ 8; }

  /// Lower end of the interval in box space, never above t * box_scale.
  float near_limit(float t) const {
    if (box_scale == 1) return t < 0x1p-126f ? 0.0f : std::min(t, 0x1p120f);
    const double scaled = double{t} * box_scale;
    return scaled < 0x1p-126 ? 0.0f : static_cast<float>(std::min(scaled, 0x1p120));
  }

  /// Upper end of the interval in box space, never below t * box_scale. t >= 0.
  float far_limit(float t) const {
    if (box_scale == 1) return std::max(t, 0x1p-126f);
    return static_cast<float>(std::max(double{t} * box_scale, 0x1p-126));  // exact, or infinite
  }
};

/// Prepares `ray` for a structure whose boxes all lie inside [bounds_min, bounds_max].
///
/// No box holding an exact hit with t_min < t is ever missed. Hits are exact for the ray as given, so pad_scale is 1
/// where primitives are tested against this very ray. In a top-level structure primitives are tested against rounded
/// copies of the ray; there pad_scale is 1 + kappa, with kappa >= |M| |W| + 2^24 |M W - I| for every instance (M its
/// object-to-world 3x3 part, W the stored inverse, infinity norms, rounded up), and the builder must have enlarged
/// every instance's world box by 2^-22 |M| b on each side, b the largest absolute coordinate of the instance's
/// object-space bounds, besides rounding the transformed corners outward.
PreparedRay prepare_ray(const Ray& ray, const float bounds_min[3], const float bounds_max[3], float pad_scale = 1);

}  // namespace rayloom::accel
