#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/ray_scale.h>

namespace rayloom::accel {
namespace {

void prepare_shear(PreparedRay& out) {
  for (int i = 0; i < 3; ++i) out.ordered_origin[i] = out.origin[out.axis[i]];
  for (int i = 0; i < 2; ++i) out.shear[i] = out.direction[out.axis[i]] / out.direction[out.axis[2]];
}

/// Largest |plane - origin| on each axis, M_k in docs/numerics.md, and the largest |coordinate|.
struct Reach {
  float axis[3];
  float largest = 0;
};

Reach measure(const Ray& ray, const float bounds_min[3], const float bounds_max[3]) {
  Reach reach;
  for (int k = 0; k < 3; ++k) {
    const float origin = ray.origin[k], low = bounds_min[k], high = bounds_max[k];
    reach.axis[k] = std::max(std::fabs(low - origin), std::fabs(high - origin));
    reach.largest = std::max({reach.largest, std::fabs(origin), std::fabs(low), std::fabs(high)});
  }
  return reach;
}

/// Reciprocal and offsets of one axis. The pad is the bound E_k of docs/numerics.md, "The box test".
void prepare_axis(PreparedRay& out, int k, float reach, const BoxScale& scale) {
  const auto component = static_cast<float>(double{out.direction[k]} * scale.direction);
  const float magnitude = 1 / std::max(std::fabs(component), scale.shortest);
  out.near_row[k] = (2 * static_cast<uint32_t>(k) + (std::signbit(out.direction[k]) ? 1 : 0)) * 8;
  out.reciprocal[k] = std::copysign(magnitude, out.direction[k]);

  const float pad = 4 * float_unit * (reach + std::fabs(out.origin[k])) + scale.common_pad;
  const float centre = -out.origin[k] * out.reciprocal[k], width = pad * magnitude;
  const bool bounded = pad <= scale.largest_pad;
  out.near_offset[k] = bounded ? centre - width : -pass_all;
  out.far_offset[k] = bounded ? centre + width : pass_all;
}

}  // namespace

PreparedRay prepare_ray(const Ray& ray, const float bounds_min[3], const float bounds_max[3], float pad_scale) {
  PreparedRay out{};
  static_cast<Ray&>(out) = ray;
  out.valid = traceable(ray);
  if (!out.valid) return out;
  order_axes(out);
  prepare_shear(out);
  const Reach reach = measure(ray, bounds_min, bounds_max);
  const float farthest = std::max({reach.axis[0], reach.axis[1], reach.axis[2]});
  const BoxScale scale = box_scale_of(out, reach.largest, farthest, pad_scale);
  for (int k = 0; k < 3; ++k) prepare_axis(out, k, reach.axis[k], scale);
  return out;
}

}  // namespace rayloom::accel
