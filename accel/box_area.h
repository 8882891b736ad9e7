#pragma once

#include <rayloom/accel/float4.h>

#include <algorithm>
#include <bit>

namespace rayloom::accel {

/// Half areas of boxes inside one box, in float: all are scaled by the same power of two, which brings the largest
/// extent near 1, so that nothing overflows however large or small the box is. To be compared with each other only.
class BoxArea {
 public:
  explicit BoxArea(const Box& whole) {
    const double extent = std::max({whole.extent(0), whole.extent(1), whole.extent(2)});
    const auto exponent = static_cast<int>(std::bit_cast<uint64_t>(extent) >> 52) - 1023;
    const int scale = std::clamp(-exponent, -129, 127);
    scale_ = splat(static_cast<float>(power_of_two(scale)));
    unit_ = power_of_two(-2 * scale);
  }

  float operator()(const Box4& box) const {
    const Float4 d = box.max * scale_ - box.min * scale_;
    return d[0] * d[1] + d[2] * (d[0] + d[1]);
  }

  /// The half area that counts as 1.
  double unit() const { return unit_; }

 private:
  static double power_of_two(int exponent) {
    return std::bit_cast<double>(static_cast<uint64_t>(1023 + exponent) << 52);
  }

  Float4 scale_;
  double unit_;
};

}  // namespace rayloom::accel
