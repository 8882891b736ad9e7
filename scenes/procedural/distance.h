#pragma once

// Distances to simple solids and ways to join them, for isosurfaces. Each changes by at most 1 a metre.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace rayloom::scenes {

inline float length(glm::vec3 v) { return std::sqrt(glm::dot(v, v)); }

/// The smaller, rounded where they differ by less than `width` (Quilez).
inline float blend(float a, float b, float width) {
  const float h = std::max(0.0f, 1 - std::fabs(a - b) / width);
  return std::min(a, b) - 0.25f * width * h * h;
}
inline float carve(float solid, float hole, float width) { return -blend(-solid, hole, width); }

/// A round cone from `a` to `b`, nearly: the radius goes linearly between.
struct Limb {
  glm::vec3 a, b;
  float radius_a, radius_b;
  float distance(glm::vec3 p) const {
    const glm::vec3 along = b - a;
    const float t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0f, 1.0f);
    return length(p - a - t * along) - (radius_a + t * (radius_b - radius_a));
  }
};

/// Too short away from the surface, never too long.
inline float ellipsoid(glm::vec3 p, glm::vec3 radii) {
  const float scaled = length(p / radii);
  return (scaled - 1) * std::min({radii.x, radii.y, radii.z});
}

}  // namespace rayloom::scenes
