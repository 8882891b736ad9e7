#pragma once

// The exact evaluation behind triangle.h, in integers: rare, simple, and free of allocation.

#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/triangle.h>
#include <rayloom/accel/triangle_determinants.h>

namespace rayloom::accel {

/// All coordinates must be finite. Sign of the edge functions E01, E12, E20 after the symbolic shift of the ray: -1 or
/// 1; 0 for a projected edge of zero length. `on_edge` tells where the unshifted function is zero.
struct ExactEdges {
  int sign[3];
  bool on_edge[3];
};
ExactEdges exact_edges(const PreparedRay& ray, const TriangleCorners& corners);

struct QuotientChoice {
  bool t = true, u = true, v = true;
  int count() const { return int{t} + int{u} + int{v}; }
};

/// Sets the chosen ones of t, u and v of a triangle that is hit, exact quotients rounded to nearest even (NaN if it is
/// edge-on), and `front`.
void exact_quotients(const PreparedRay& ray, const TriangleCorners& corners, const QuotientChoice& chosen,
                     TriangleHit& hit);

}  // namespace rayloom::accel
