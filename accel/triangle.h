#pragma once

// Exact ray/triangle intersection (guarantees G1 and G2). Whether a triangle is hit is the sign of three determinants
// of the float32 input taken without error, ties decided by one symbolic shift of the ray that is the same for every
// triangle; t, u and v are the exact quotients rounded to nearest. So the answer depends on the input alone, not on
// the code that computed it. Proofs: docs/numerics.md.

#include <rayloom/accel/prepared_ray.h>

#include <limits>
#include <optional>

namespace rayloom::accel {

/// t, u, v correctly rounded; u and v (weights of vertices 1 and 2) satisfy u, v >= 0 and u + v <= 1 in float.
struct TriangleHit {
  float t, u, v;
  bool front;  ///< cross(v1 - v0, v2 - v0) . direction < 0 (CU-01)

  uint32_t hit_kind() const { return front ? hit_kind_triangle_front_face : hit_kind_triangle_back_face; }
};

/// The hit of the infinite line with the triangle, if ray.t_min < t <= t_far for the rounded t. The caller decides
/// whether t == t_far counts (a ray's own t_max is exclusive; equal committed hits follow the tie rule of G3b).
/// Degenerate and edge-on triangles and those with a non-finite vertex are never hit.
std::optional<TriangleHit> intersect_triangle(const PreparedRay& ray, const float v0[3], const float v1[3],
                                              const float v2[3], float t_far = std::numeric_limits<float>::infinity());

/// The same for a triangle that a filter has found to be certainly hit (LeafMasks::certain): skips the decision.
std::optional<TriangleHit> finish_triangle(const PreparedRay& ray, const float v0[3], const float v1[3],
                                           const float v2[3], float t_far = std::numeric_limits<float>::infinity());

}  // namespace rayloom::accel
