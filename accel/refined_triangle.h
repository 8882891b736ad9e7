#pragma once

// The hits that doubles leave undecided: in double-double, which decides all but exact ties in practice, then in
// integers.

#include <rayloom/accel/triangle.h>
#include <rayloom/accel/triangle_determinants.h>

#include <limits>
#include <optional>

namespace rayloom::accel {

/// Whether a rounded t counts.
inline bool in_range(const PreparedRay& ray, float t, float t_far) {
  return t > ray.t_min && t <= t_far && t <= std::numeric_limits<float>::max();
}

/// Which arithmetic a hit took; for tests and measurements.
struct TriangleEffort {
  bool refined = false;        ///< double-double was needed
  bool integer_signs = false;  ///< integers decided whether the triangle is hit
  int integer_quotients = 0;   ///< how many of t, u and v integers gave
};

/// intersect_triangle() and finish_triangle(), without trying doubles. `certain`: the line is known to hit.
std::optional<TriangleHit> refined_hit(const PreparedRay& ray, TriangleCorners corners, float t_far, bool certain,
                                       TriangleEffort& effort);

/// intersect_triangle() or, for a certain hit, finish_triangle(), with a report.
std::optional<TriangleHit> observed_hit(const PreparedRay& ray, const TriangleCorners& corners, float t_far,
                                        bool certain, TriangleEffort& effort);

}  // namespace rayloom::accel
