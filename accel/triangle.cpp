#include <rayloom/accel/triangle_hit.h>

namespace rayloom::accel {
std::optional<TriangleHit> intersect_triangle(const PreparedRay& ray, const float v0[3], const float v1[3],
                                              const float v2[3], float t_far) {
  TriangleEffort effort;
  return hit_of<false>(ray, {{v0, v1, v2}}, t_far, effort);
}

std::optional<TriangleHit> finish_triangle(const PreparedRay& ray, const float v0[3], const float v1[3],
                                           const float v2[3], float t_far) {
  TriangleEffort effort;
  return hit_of<true>(ray, {{v0, v1, v2}}, t_far, effort);
}

std::optional<TriangleHit> observed_hit(const PreparedRay& ray, const TriangleCorners& corners, float t_far,
                                        bool certain, TriangleEffort& effort) {
  return certain ? hit_of<true>(ray, corners, t_far, effort) : hit_of<false>(ray, corners, t_far, effort);
}

}  // namespace rayloom::accel
