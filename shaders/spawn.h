#pragma once

// Where rays may start that leave a surface: just off it, by a bound on every rounding between here and the hit test.
// The idea is that of NVIDIA's self-intersection avoidance (bound the object-space and the world-space error, step off
// along the geometric normal), with the constants of our own arithmetic: docs/numerics.md, "Spawn points".

#include <rayloom/shaders/vector_math.h>

#include <array>
#include <glm/vec3.hpp>

namespace rayloom::shaders {

using double3 = glm::dvec3;

struct SpawnPoint {
  double3 position;  ///< on the surface, world space
  double3 normal;    ///< unit, world space: to the side from which the surface shows its front
  double3 start;     ///< the same, kept off the surface's edges by what rounding may do
  double offset;     ///< an origin this far from `start` along +-normal is safe on that side
  double grazing;    ///< the sine that a ray's angle with the surface must exceed, below 1e-6 for mild transforms

  /// A float origin on the front (or the back) of the surface. Rays that leave to that side with
  /// |dot(direction, normal)| > grazing |direction| do not hit the surface they came from.
  float3 origin(bool front) const { return float3(start + (front ? offset : -offset) * normal); }
};

/// `barycentrics`: weights of vertices 1 and 2 as a hit reports them; vertices in object space, the matrix as the
/// context gives it.
SpawnPoint triangle_spawn_point(const std::array<float3, 3>& vertices, float2 barycentrics,
                                const float3x4& object_to_world);

/// The point of the sphere nearest to `object_point`; front is outside.
SpawnPoint sphere_spawn_point(float3 center, float radius, double3 object_point, const float3x4& object_to_world);

}  // namespace rayloom::shaders
