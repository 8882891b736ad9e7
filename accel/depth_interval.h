#pragma once

#include <rayloom/accel/prepared_ray.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayloom::accel {

/// A ray's interval (t_min, t_far] as depths along its dominant axis, coordinates there minus the origin's. A hit lies
/// between the depths of its triangle's vertices, so a triangle that lies beyond an outer limit is not hit in the
/// interval, and one between the inner limits is hit in it or not at all. Margins: docs/numerics.md, "Depths".
struct DepthInterval {
  float outer_low, outer_high;
  float inner_low, inner_high;

  DepthInterval(const PreparedRay& ray, float t_far) {
    constexpr float more = 1 + 0x1p-20f, less = 1 - 0x1p-20f;
    const float step = ray.direction[ray.axis[2]], length = std::fabs(step);
    const float tiny = 0x1p-120f * std::max(length, 1.0f);  // t may be subnormal
    const float near = ray.t_min * length, far = t_far * length;
    const float outer_near = near * less - tiny, outer_far = far * more + tiny;
    const float last = std::min(t_far, std::numeric_limits<float>::max()) * length;  // an infinite t is no hit
    const float inner_near = near * more + tiny, inner_far = last * less - tiny;
    const bool forward = step > 0;
    outer_low = forward ? outer_near : -outer_far;
    outer_high = forward ? outer_far : -outer_near;
    inner_low = forward ? inner_near : -inner_far;
    inner_high = forward ? inner_far : -inner_near;
  }
};

}  // namespace rayloom::accel
