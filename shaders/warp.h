#pragma once

// Maps from the unit square to the domains shaders sample, each area preserving.

#include <rayloom/base/det_math.h>
#include <rayloom/shaders/vector_math.h>

#include <cmath>

namespace rayloom::shaders {

/// Unit direction at height z above the xy plane and turn `u` of a full circle.
inline float3 direction_at(float z, float u) {
  const float r = std::sqrt(std::fmax(0.0f, 1.0f - z * z));
  const det::SinCos<float> turn = det::sincos(2.0f * pi * u);
  return {r * turn.cos, r * turn.sin, z};
}

inline float3 uniform_sphere(float2 u) { return direction_at(1.0f - 2.0f * u.x, u.y); }
inline constexpr float uniform_sphere_pdf = 0.25f * inverse_pi;

/// Cosine-weighted about +z; density z / pi. Never quite in the plane, where that density is zero.
inline float3 cosine_hemisphere(float2 u) { return direction_at(std::sqrt(std::fmax(1.0f - u.x, 0x1p-24f)), u.y); }

/// Barycentrics (of vertices 1 and 2), uniform over a triangle. Heitz 2019, "A Low-Distortion Map Between Triangle and
/// Square".
inline float2 uniform_triangle(float2 u) {
  return u.y > u.x ? float2(0.5f * u.x, u.y - 0.5f * u.x) : float2(u.x - 0.5f * u.y, 0.5f * u.y);
}

}  // namespace rayloom::shaders
