#pragma once

// The few vector helpers the shaders share, on top of the runtime's HLSL vocabulary.

#include <rayloom/runtime/hlsl.h>

#include <cmath>

namespace rayloom::shaders {

inline constexpr float pi = 3.14159265358979323846f;
inline constexpr float inverse_pi = 0.31830988618379067154f;

/// Rec. 709 luminance of linear RGB.
inline float luminance(float3 rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }
inline float largest_component(float3 v) { return std::fmax(v.x, std::fmax(v.y, v.z)); }
inline float square(float x) { return x * x; }

/// A right-handed orthonormal frame around a unit normal.
struct Frame {
  float3 tangent, bitangent, normal;

  float3 to_local(float3 v) const { return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)}; }
  float3 to_world(float3 v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

/// Any frame around `normal`. Duff et al. 2017, "Building an Orthonormal Basis, Revisited" (JCGT 6:1).
inline Frame make_frame(float3 normal) {
  const float sign = std::copysign(1.0f, normal.z);
  const float a = -1.0f / (sign + normal.z);
  const float b = normal.x * normal.y * a;
  return {{1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
          {b, sign + normal.y * normal.y * a, -normal.y},
          normal};
}

/// `v` made unit length; `fallback` where it has no direction (zero, infinite or NaN).
inline float3 normalize_or(float3 v, float3 fallback) {
  const float length_squared = glm::dot(v, v);
  return length_squared > 0 && length_squared < INFINITY ? v / std::sqrt(length_squared) : fallback;
}

}  // namespace rayloom::shaders
