#pragma once

#include <rayloom/accel/prepared_ray.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayloom::accel {

/// A ray's interval (t_min, t_far] as depths along its dominant axis: coordinates there minus the origin's, times the
/// direction's sign. A triangle's hit is outside the interval beyond an outer limit, and in it between the inner ones.
/// Margins: docs/numerics.md, "Depths".
struct DepthLimits {
  float outer_near, outer_far, inner_near, inner_far;
  float sign;  ///< 0 or -0, as the dominant component: what to flip the sign bit by
};

/// The limits of one ray, and how they follow from t.
struct DepthInterval : DepthLimits {
  static constexpr float more = 1 + 0x1p-20f, less = 1 - 0x1p-20f;
  static constexpr float tiny = 0x1p-60f;  ///< of a depth

  DepthInterval() = default;
  DepthInterval(const PreparedRay& ray, float t_far) {
    const float step = ray.direction[ray.axis[2]];
    sign = std::copysign(0.0f, step);
    length_ = std::fabs(step);
    tiny_ = tiny * (length_ + 1);
    const float near = ray.t_min * length_;
    outer_near = near * less - tiny_;
    inner_near = near * more + tiny_;
    shorten(t_far);
  }

  void shorten(float t_far) {
    const float far = std::min(t_far, std::numeric_limits<float>::max()) * length_;  // an infinite t is no hit
    outer_far = far * more + tiny_;
    inner_far = far * less - tiny_;
  }

 private:
  float length_;  ///< the component's magnitude
  float tiny_;    ///< covers a subnormal t, and is so large that no product with an ordinary area is one
};

}  // namespace rayloom::accel
