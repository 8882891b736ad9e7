#pragma once

#include <algorithm>
#include <limits>

namespace rayloom::accel {

/// Axis-aligned box. Empty (minimum above maximum) until something is added; adding is exact and order-independent.
struct Box {
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  float min[3] = {infinity, infinity, infinity};
  float max[3] = {-infinity, -infinity, -infinity};

  void extend(const float (&low)[3], const float (&high)[3]) {
    for (int k = 0; k < 3; ++k) {
      min[k] = std::min(min[k], low[k]);
      max[k] = std::max(max[k], high[k]);
    }
  }
  void extend(const float (&point)[3]) { extend(point, point); }
  void extend(const Box& box) { extend(box.min, box.max); }

  bool empty() const { return !(min[0] <= max[0]); }
  /// In double, where the largest float extents neither overflow when subtracted nor when multiplied. 0 when empty.
  double extent(int axis) const { return empty() ? 0.0 : double{max[axis]} - double{min[axis]}; }
  double half_area() const {
    const double x = extent(0), y = extent(1), z = extent(2);
    return x * y + y * z + z * x;
  }
};

}  // namespace rayloom::accel
