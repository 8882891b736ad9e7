#pragma once

// Where rays may start that leave a surface: just off it, by a bound on every rounding between here and the hit test.
// The idea is that of NVIDIA's self-intersection avoidance (bound the object-space and the world-space error, step off
// along the geometric normal), with the constants of our own arithmetic.
//
// Bound. Let u = 2^-24. The hit point P is computed in double on the triangle's plane (barycentrics may be rounded: any
// pair names a point of that plane), mapped to world space in double, moved by d along the unit normal N and rounded to
// float once: the origin Q differs from P + d N by at most u |Q_i| an axis. Traversal maps Q to object space in double
// and rounds once: u |o_i| an axis there (accel/instance_transform). With n the object-space unit normal and
// k = |M^-T n|, Q lies k d - k sum |N_i| u |Q_i| - sum |n_i| u |o_i| above the plane, so
//   d > u sum |N_i| |P_i| + (u / k) sum |n_i| |o_i|
// keeps it off its own triangle; the exact hit test (guarantee G1) then needs no more. Vertices of neighbours in one
// plane are themselves rounded by u |v_i|, which the bound includes, and all of it is taken a quarter larger for the
// errors of double and of d itself.

#include <rayloom/shaders/vector_math.h>

#include <array>
#include <glm/vec3.hpp>

namespace rayloom::shaders {

using double3 = glm::dvec3;

struct SpawnPoint {
  double3 position;  ///< on the surface, world space
  double3 normal;    ///< unit, world space: to the side from which the surface shows its front
  double offset;     ///< an origin this far from `position` along +-normal is safe on that side

  /// A float origin on the front (or the back) of the surface. Rays that leave to that side do not hit the surface they
  /// came from, provided they make an angle with it: |dot(direction, normal)| > 1e-6 |direction|.
  float3 origin(bool front) const { return float3(position + (front ? offset : -offset) * normal); }
};

/// `barycentrics`: weights of vertices 1 and 2 as a hit reports them; vertices in object space, 3x4 matrices as the
/// context gives them.
SpawnPoint triangle_spawn_point(const std::array<float3, 3>& vertices, float2 barycentrics,
                                const float3x4& object_to_world, const float3x4& world_to_object);

/// The point of the sphere nearest to `object_point`; front is outside.
SpawnPoint sphere_spawn_point(float3 center, float radius, double3 object_point, const float3x4& object_to_world,
                              const float3x4& world_to_object);

}  // namespace rayloom::shaders
