#include <rayloom/accel/prepared_ray.h>

#include <bit>
#include <cmath>

namespace rayloom::accel {
namespace {

constexpr double float_unit = 0x1p-24;  // u: half the distance from 1 to the next float

/// Exponent e of a positive value in [2^e, 2^(e+1)).
int exponent_of(double value) { return static_cast<int>(std::bit_cast<uint64_t>(value) >> 52) - 1023; }

double power_of_two(int exponent) { return std::bit_cast<double>(static_cast<uint64_t>(exponent + 1023) << 52); }

bool finite(const float (&p)[3]) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

/// TR-17, TR-18, TR-19: an infinite t_max is a ray, an infinite t_min one that hits nothing.
bool traceable(const Ray& ray) {
  const bool moves = ray.direction[0] != 0 || ray.direction[1] != 0 || ray.direction[2] != 0;
  return finite(ray.origin) && finite(ray.direction) && moves && ray.t_min >= 0 && ray.t_min <= ray.t_max;
}

uint32_t dominant_axis(const float (&direction)[3]) {
  const float x = std::fabs(direction[0]), y = std::fabs(direction[1]), z = std::fabs(direction[2]);
  if (x >= y && x >= z) return 0;
  return y >= z ? 1 : 2;
}

void prepare_shear(PreparedRay& out) {
  const uint32_t z = dominant_axis(out.direction);
  out.axis[0] = (z + 1) % 3;
  out.axis[1] = (z + 2) % 3;
  out.axis[2] = z;
  out.inverse_z = 1 / double{out.direction[z]};
  for (int i = 0; i < 2; ++i) {
    out.shear_double[i] = double{out.direction[out.axis[i]]} / double{out.direction[z]};
    out.shear[i] = out.direction[out.axis[i]] / out.direction[z];
  }
}

/// Sizes that box constants are derived from, all of them exact or rounded in double only.
struct Scale {
  double reach[3];    ///< largest |plane - origin| on each axis, M_k in docs/numerics.md
  double coordinate;  ///< a power of two above every |origin| and |plane|, 2^m
  double step;        ///< lower end of the scaled direction's dominant component, 2^q
};

Scale measure(const Ray& ray, const float bounds_min[3], const float bounds_max[3]) {
  Scale scale{};
  double largest = 0x1p-149;
  for (int k = 0; k < 3; ++k) {
    const double origin = ray.origin[k], low = bounds_min[k], high = bounds_max[k];
    scale.reach[k] = std::max(std::fabs(low - origin), std::fabs(high - origin));
    largest = std::max({largest, std::fabs(origin), std::fabs(low), std::fabs(high)});
  }
  const int m = std::min(exponent_of(largest), 127) + 1;
  scale.coordinate = power_of_two(m);
  scale.step = power_of_two(std::max(0, m - 26));
  return scale;
}

/// Both sides of a plane interval pass every box: the pad exceeds the structure.
constexpr float pass_all = 0x1.fffffep127f;

/// Reciprocal and offsets of one axis. The pad is the bound E_k of docs/numerics.md, "The box test".
void prepare_axis(PreparedRay& out, int k, const Scale& scale, double transform_pad, double tiny_pad) {
  const double component = double{out.direction[k]} / out.box_scale;
  const double shortest = 0x1p-96 * scale.step;
  const double magnitude = 1 / std::max(std::fabs(component), shortest);
  out.near_side[k] = std::signbit(component) ? 1 : 0;
  out.reciprocal[k] = static_cast<float>(std::copysign(magnitude, component));

  const double origin = out.origin[k];
  const double pad =
      float_unit * (4 * scale.reach[k] + 2 * std::fabs(origin)) + 0x1p-48 * scale.coordinate + transform_pad + tiny_pad;
  const double centre = -origin * double{out.reciprocal[k]};
  const double width = pad * std::fabs(double{out.reciprocal[k]});
  const bool bounded = pad <= scale.coordinate;
  out.near_offset[k] = bounded ? static_cast<float>(centre - width) : -pass_all;
  out.far_offset[k] = bounded ? static_cast<float>(centre + width) : pass_all;
}

void prepare_boxes(PreparedRay& out, const Scale& scale, float pad_scale) {
  const double dominant = std::fabs(double{out.direction[out.axis[2]]});
  out.box_scale = power_of_two(exponent_of(dominant)) / scale.step;
  const double reach = std::max({scale.reach[0], scale.reach[1], scale.reach[2]});
  const double transform_pad = pad_scale > 1 ? 8 * float_unit * (double{pad_scale} - 1) * reach : 0;
  const double tiny_pad = 0x1p-147 * (scale.step + dominant);
  for (int k = 0; k < 3; ++k) prepare_axis(out, k, scale, transform_pad, tiny_pad);
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
