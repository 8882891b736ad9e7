#include <rayloom/accel/prepared_ray.h>

#include <bit>
#include <cmath>

namespace rayloom::accel {
namespace {

constexpr double float_unit = 0x1p-24;  // u: half the distance from 1 to the next float

/// Exponent e of a positive value in [2^e, 2^(e+1)).
int exponent_of(double value) { return static_cast<int>(std::bit_cast<uint64_t>(value) >> 52) - 1023; }

double power_of_two(int exponent) { return std::bit_cast<double>(static_cast<uint64_t>(exponent + 1023) << 52); }

bool finite(const float (&p)[3]) {
  const auto finite_magnitude = [](float value) {
    return (std::bit_cast<uint32_t>(value) & 0x7FFFFFFF) < 0x7F800000;  // without branches
  };
  return finite_magnitude(p[0]) & finite_magnitude(p[1]) & finite_magnitude(p[2]);
}

/// TR-17, TR-18, TR-19: an infinite t_max is a ray, an infinite t_min one that hits nothing.
bool traceable(const Ray& ray) {
  const bool moves = (ray.direction[0] != 0) | (ray.direction[1] != 0) | (ray.direction[2] != 0);
  return finite(ray.origin) & finite(ray.direction) & moves & (ray.t_min >= 0) & (ray.t_min <= ray.t_max);
}

uint32_t dominant_axis(const float (&direction)[3]) {
  const float x = std::fabs(direction[0]), y = std::fabs(direction[1]), z = std::fabs(direction[2]);
  const uint32_t first = y > x;
  return z > std::max(x, y) ? 2 : first;
}

void prepare_shear(PreparedRay& out) {
  constexpr uint32_t following[] = {0, 1, 2, 0, 1};
  const uint32_t z = dominant_axis(out.direction);
  out.axis[0] = following[z + 1];
  out.axis[1] = following[z + 2];
  out.axis[2] = z;
  out.inverse_z = 1 / double{out.direction[z]};
  for (int i = 0; i < 2; ++i) {
    out.shear_double[i] = double{out.direction[out.axis[i]]} * out.inverse_z;
    out.shear[i] = static_cast<float>(out.shear_double[i]);
  }
}

/// Sizes that box constants are derived from, all of them exact or rounded in double only.
struct Scale {
  double reach[3];  ///< largest |plane - origin| on each axis, M_k in docs/numerics.md
  int coordinate;   ///< exponent m: 2^m is above every |origin| and |plane|
  int step;         ///< exponent q: the scaled direction's dominant component lies in [2^q, 2^(q + 1))
};

Scale measure(const Ray& ray, const float bounds_min[3], const float bounds_max[3]) {
  Scale scale{};
  double largest = 0x1p-149;
  for (int k = 0; k < 3; ++k) {
    const double origin = ray.origin[k], low = bounds_min[k], high = bounds_max[k];
    scale.reach[k] = std::max(std::fabs(low - origin), std::fabs(high - origin));
    largest = std::max({largest, std::fabs(origin), std::fabs(low), std::fabs(high)});
  }
  scale.coordinate = std::min(exponent_of(largest), 127) + 1;
  scale.step = std::max(0, scale.coordinate - 26);
  return scale;
}

/// Both sides of a plane interval pass every box: the pad exceeds the structure.
constexpr float pass_all = 0x1.fffffep127f;

/// Constants of all three axes.
struct BoxScale {
  double direction;   ///< the factor, a power of two, that takes the direction to box space
  double shortest;    ///< scaled components below this are taken for it
  double common_pad;  ///< the part of the pad that is equal on all axes
  double largest_pad;
};

/// Reciprocal and offsets of one axis. The pad is the bound E_k of docs/numerics.md, "The box test".
void prepare_axis(PreparedRay& out, int k, double reach, const BoxScale& scale) {
  const double component = double{out.direction[k]} * scale.direction;
  const double magnitude = 1 / std::max(std::fabs(component), scale.shortest);
  out.near_side[k] = std::signbit(out.direction[k]) ? 1 : 0;
  out.reciprocal[k] = static_cast<float>(std::copysign(magnitude, component));

  const double origin = out.origin[k], reciprocal = out.reciprocal[k];
  const double pad = float_unit * (4 * reach + 2 * std::fabs(origin)) + scale.common_pad;
  const double centre = -origin * reciprocal, width = pad * std::fabs(reciprocal);
  const bool bounded = pad <= scale.largest_pad;
  out.near_offset[k] = bounded ? static_cast<float>(centre - width) : -pass_all;
  out.far_offset[k] = bounded ? static_cast<float>(centre + width) : pass_all;
}

void prepare_boxes(PreparedRay& out, const Scale& scale, float pad_scale) {
  const double dominant = std::fabs(double{out.direction[out.axis[2]]});
  const int shift = exponent_of(dominant) - scale.step;
  out.box_scale = power_of_two(shift);
  const double coordinate = power_of_two(scale.coordinate), step = power_of_two(scale.step);
  const double reach = std::max({scale.reach[0], scale.reach[1], scale.reach[2]});
  const double transform_pad = 8 * float_unit * (std::max(1.0f, pad_scale) - 1.0) * reach;
  const BoxScale box{power_of_two(-shift), 0x1p-96 * step,
                     0x1p-48 * coordinate + 0x1p-147 * (step + dominant) + transform_pad, coordinate};
  for (int k = 0; k < 3; ++k) prepare_axis(out, k, scale.reach[k], box);
}

}  // namespace

PreparedRay prepare_ray(const Ray& ray, const float bounds_min[3], const float bounds_max[3], float pad_scale) {
  PreparedRay out{};
  out.t_min = ray.t_min;
  out.t_max = ray.t_max;
  out.valid = traceable(ray);
  if (!out.valid) return out;
  std::copy_n(ray.origin, 3, out.origin);
  std::copy_n(ray.direction, 3, out.direction);
  prepare_shear(out);
  prepare_boxes(out, measure(ray, bounds_min, bounds_max), pad_scale);
  return out;
}

}  // namespace rayloom::accel
