// prepare_ray() on vectors of four, one lane an axis. The operations and their order are those of
// prepared_ray.cpp, so every bit is equal. Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PREPARE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PREPARE_INL_H_
#undef RAYLOOM_ACCEL_PREPARE_INL_H_
#else
#define RAYLOOM_ACCEL_PREPARE_INL_H_
#endif
// clang-format on

#include <rayloom/accel/layout.h>
#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/ray_scale.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

using Axes = hn::FixedTag<float, 4>;
using AxisWords = hn::FixedTag<uint32_t, 4>;
using WideAxes = hn::FixedTag<double, 4>;

/// Three floats; the fourth lane repeats the first, so that it can neither raise a maximum nor be a subnormal.
HWY_INLINE hn::Vec<Axes> load_axes(const float* three) {
  alignas(16) static constexpr int32_t first_again[] = {0, 1, 2, 0};
  const Axes d;
  return hn::TableLookupLanes(hn::LoadU(d, three), hn::SetTableIndices(d, first_again));
}

HWY_INLINE float largest_lane(hn::Vec<Axes> v) {
  v = hn::Max(v, hn::Shuffle1032(v));
  return hn::GetLane(hn::Max(v, hn::Shuffle2301(v)));
}

/// See accel::traceable().
HWY_INLINE bool traceable_lanes(const Ray& ray, hn::Vec<Axes> origin, hn::Vec<Axes> direction) {
  const Axes d;
  const auto infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const auto finite = hn::And(hn::Lt(hn::Abs(origin), infinity), hn::Lt(hn::Abs(direction), infinity));
  const bool moves = !hn::AllFalse(d, hn::Ne(direction, hn::Zero(d)));
  return hn::AllTrue(d, finite) & moves & (ray.t_min >= 0) & (ray.t_min <= ray.t_max);
}

/// See prepare_ray(); the header's bounds are followed by other members, so whole vectors may be read.
HWY_INLINE void prepare_lanes(const Ray& ray, const StructureHeader& header, float pad_scale, PreparedRay& out) {
  const Axes d;
  static_cast<Ray&>(out) = ray;
  const hn::Vec<Axes> origin = load_axes(ray.origin), direction = load_axes(ray.direction);
  out.valid = traceable_lanes(ray, origin, direction);
  if (!out.valid) return;
  order_axes(out);
  for (int i = 0; i < 3; ++i) out.ordered_origin[i] = ray.origin[out.axis[i]];
  for (int i = 0; i < 2; ++i) out.shear[i] = ray.direction[out.axis[i]] / ray.direction[out.axis[2]];

  const hn::Vec<Axes> low = load_axes(header.bounds_min), high = load_axes(header.bounds_max);
  const hn::Vec<Axes> reach = hn::Max(hn::Abs(hn::Sub(low, origin)), hn::Abs(hn::Sub(high, origin)));
  const float largest = largest_lane(hn::Max(hn::Abs(origin), hn::Max(hn::Abs(low), hn::Abs(high))));
  const BoxScale scale = box_scale_of(out, largest, largest_lane(reach), pad_scale);

  const WideAxes w;
  const hn::Vec<Axes> component = hn::DemoteTo(d, hn::Mul(hn::PromoteTo(w, direction), hn::Set(w, scale.direction)));
  const hn::Vec<Axes> magnitude = hn::Div(hn::Set(d, 1.0f), hn::Max(hn::Abs(component), hn::Set(d, scale.shortest)));
  const hn::Vec<Axes> reciprocal = hn::CopySign(magnitude, direction);
  hn::Store(reciprocal, d, out.reciprocal);

  const hn::Vec<Axes> pad =
      hn::Add(hn::Mul(hn::Set(d, 4 * float_unit), hn::Add(reach, hn::Abs(origin))), hn::Set(d, scale.common_pad));
  const hn::Vec<Axes> centre = hn::Mul(hn::Neg(origin), reciprocal), width = hn::Mul(pad, magnitude);
  const auto bounded = hn::Le(pad, hn::Set(d, scale.largest_pad));
  const hn::Vec<Axes> all = hn::Set(d, pass_all);
  hn::Store(hn::IfThenElse(bounded, hn::Sub(centre, width), hn::Neg(all)), d, out.near_offset);
  hn::Store(hn::IfThenElse(bounded, hn::Add(centre, width), all), d, out.far_offset);

  const AxisWords u;
  alignas(16) static constexpr uint32_t rows[] = {0, 16, 32, 0};
  const auto side = hn::ShiftLeft<3>(hn::ShiftRight<31>(hn::BitCast(u, direction)));
  hn::Store(hn::Add(hn::Load(u, rows), side), u, out.near_row);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
