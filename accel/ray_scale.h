#pragma once

// The parts of ray preparation that plain and vector code share: checks, the order of the axes, and the powers of two
// and pads of box space (docs/numerics.md, "The box test").

#include <rayloom/accel/prepared_ray.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rayloom::accel {

inline constexpr float float_unit = 0x1p-24f;  // u: half the distance from 1 to the next float

/// Both sides of a plane interval pass every box: the pad exceeds the structure.
inline constexpr float pass_all = 0x1.fffffep127f;

/// Exponent e of a positive value in [2^e, 2^(e+1)).
inline int exponent_of(double value) { return static_cast<int>(std::bit_cast<uint64_t>(value) >> 52) - 1023; }

inline double power_of_two(int exponent) { return std::bit_cast<double>(static_cast<uint64_t>(exponent + 1023) << 52); }

inline bool finite(const float (&p)[3]) {
  const auto finite_magnitude = [](float value) {
    return (std::bit_cast<uint32_t>(value) & 0x7FFFFFFF) < 0x7F800000;  // without branches
  };
  return finite_magnitude(p[0]) & finite_magnitude(p[1]) & finite_magnitude(p[2]);
}

/// TR-17, TR-18, TR-19: an infinite t_max is a ray, an infinite t_min one that hits nothing.
inline bool traceable(const Ray& ray) {
  const bool moves = (ray.direction[0] != 0) | (ray.direction[1] != 0) | (ray.direction[2] != 0);
  return finite(ray.origin) & finite(ray.direction) & moves & (ray.t_min >= 0) & (ray.t_min <= ray.t_max);
}

/// Sets PreparedRay::axis from its direction.
inline void order_axes(PreparedRay& out) {
  static constexpr uint32_t following[] = {0, 1, 2, 0, 1};
  const float x = std::fabs(out.direction[0]), y = std::fabs(out.direction[1]), z = std::fabs(out.direction[2]);
  const uint32_t first = y > x, last = (z > x) & (z > y);
  const uint32_t largest = first + last * (2 - first);  // a branch would be mispredicted
  out.axis[0] = following[largest + 1];
  out.axis[1] = following[largest + 2];
  out.axis[2] = largest;
}

/// Rays and structures of ordinary sizes have box space equal to t, and one of the two powers of two below is 1.
inline constexpr float longest_moderate = 0x1p20f, shortest_moderate = 0x1p-20f, largest_moderate = 0x1p26f;

/// Constants of all three axes.
struct BoxScale {
  double time;       ///< the factor, a power of two, that takes t to box space
  double direction;  ///< its inverse, which takes the direction there
  float shortest;    ///< scaled components below this are taken for it
  float common_pad;  ///< the part of the pad that is equal on all axes
  float largest_pad;
};

inline float float_power_of_two(int exponent) {
  return std::bit_cast<float>(static_cast<uint32_t>(exponent + 127) << 23);
}

/// What a top level's pad grows by for each unit of reach; see prepare_ray().
inline float transform_pad_of(float pad_scale) { return 8 * float_unit * (std::max(1.0f, pad_scale) - 1); }

inline constexpr float moderate_shortest = 0x1p-96f;
/// At least half the power of two above every coordinate.
inline float moderate_size(float largest) { return std::max(largest, 0x1p-79f); }
inline float moderate_pad(float size) { return 0x1p-47f * size + 0x1p-126f; }

inline BoxScale moderate_scale(float largest, float transform_pad) {
  const float size = moderate_size(largest);
  return {1, 1, moderate_shortest, moderate_pad(size) + transform_pad, size};
}

/// With 2^m above every coordinate, the scaled direction's dominant component lies in [2^q, 2^(q + 1)). No constant is
/// subnormal: arithmetic on those is a hundred times slower.
inline BoxScale extreme_scale(float dominant, float largest, float transform_pad) {
  const int m = std::min(static_cast<int>(std::bit_cast<uint32_t>(largest) >> 23) - 126, 127);
  const int q = std::max(0, m - 26);
  const int shift = exponent_of(double{dominant}) - q;
  const float coordinate = float_power_of_two(std::max(m, -78));
  const float common_pad = 0x1p-48f * coordinate + 0x1p-46f * (0x1p-100f * std::max(dominant, 0x1p21f)) + transform_pad;
  return {power_of_two(shift), power_of_two(-shift), float_power_of_two(q - 96), common_pad, coordinate};
}

/// `dominant`: magnitude of the direction's largest component; `largest`: largest |coordinate| of origin and bounds;
/// `reach`: largest |plane - origin|.
inline BoxScale box_scale_of(float dominant, float largest, float reach, float pad_scale) {
  const float transform_pad = transform_pad_of(pad_scale) * reach;
  if (dominant >= shortest_moderate && dominant <= longest_moderate && largest < largest_moderate)
    return moderate_scale(largest, transform_pad);
  return extreme_scale(dominant, largest, transform_pad);
}

/// The same for a ray whose axes are ordered; also sets PreparedRay::box_scale.
inline BoxScale box_scale_of(PreparedRay& out, float largest, float reach, float pad_scale) {
  const BoxScale scale = box_scale_of(std::fabs(out.direction[out.axis[2]]), largest, reach, pad_scale);
  out.box_scale = scale.time;
  return scale;
}

}  // namespace rayloom::accel
