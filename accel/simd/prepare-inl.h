// prepare_ray() on vectors of four doubles, one lane an axis. The operations and their order are those of
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
using WideVector = hn::Vec<WideAxes>;

/// Three floats; the fourth lane repeats the first, so that it can neither raise a maximum nor be a subnormal.
HWY_INLINE hn::Vec<Axes> load_axes(const float* three) {
  alignas(16) static constexpr int32_t first_again[] = {0, 1, 2, 0};
  const Axes d;
  return hn::TableLookupLanes(hn::LoadU(d, three), hn::SetTableIndices(d, first_again));
}

HWY_INLINE double largest_lane(WideVector v) {
  const hn::Half<WideAxes> half;
  const auto pair = hn::Max(hn::LowerHalf(half, v), hn::UpperHalf(half, v));
  return hn::GetLane(hn::Max(pair, hn::Shuffle01(pair)));
}

HWY_INLINE void prepare_shear_lanes(PreparedRay& out, double box_magnitude, double box_direction) {
  // The reciprocal of the dominant component is the boxes' up to a power of two.
  out.inverse_z = std::copysign(box_magnitude * box_direction, double{out.direction[out.axis[2]]});
  for (int i = 0; i < 3; ++i) out.ordered_origin[i] = out.origin[out.axis[i]];
  for (int i = 0; i < 2; ++i) {
    out.shear_double[i] = double{out.direction[out.axis[i]]} * out.inverse_z;
    out.shear[i] = static_cast<float>(out.shear_double[i]);
  }
}

/// See prepare_ray(); the header's bounds are followed by other members, so whole vectors may be read.
HWY_INLINE void prepare_lanes(const Ray& ray, const StructureHeader& header, float pad_scale, PreparedRay& out) {
  const WideAxes w;
  const Axes d;
  static_cast<Ray&>(out) = ray;
  out.valid = traceable(ray);
  if (!out.valid) return;
  order_axes(out);

  const hn::Vec<Axes> narrow_direction = load_axes(ray.direction);
  const WideVector origin = hn::PromoteTo(w, load_axes(ray.origin)), direction = hn::PromoteTo(w, narrow_direction);
  const WideVector low = hn::PromoteTo(w, load_axes(header.bounds_min));
  const WideVector high = hn::PromoteTo(w, load_axes(header.bounds_max));
  const WideVector reach = hn::Max(hn::Abs(hn::Sub(low, origin)), hn::Abs(hn::Sub(high, origin)));
  const double largest = largest_lane(hn::Max(hn::Abs(origin), hn::Max(hn::Abs(low), hn::Abs(high))));
  const BoxScale scale = box_scale_of(out, largest, largest_lane(reach), pad_scale);

  const WideVector component = hn::Mul(direction, hn::Set(w, scale.direction));
  const WideVector magnitude = hn::Div(hn::Set(w, 1.0), hn::Max(hn::Abs(component), hn::Set(w, scale.shortest)));
  const hn::Vec<Axes> narrow = hn::CopySign(hn::DemoteTo(d, magnitude), narrow_direction);
  hn::Store(narrow, d, out.reciprocal);

  const WideVector reciprocal = hn::PromoteTo(w, narrow);
  const WideVector sizes = hn::Add(hn::Mul(hn::Set(w, 4.0), reach), hn::Mul(hn::Set(w, 2.0), hn::Abs(origin)));
  const WideVector pad = hn::Add(hn::Mul(hn::Set(w, float_unit), sizes), hn::Set(w, scale.common_pad));
  const WideVector centre = hn::Mul(hn::Neg(origin), reciprocal), width = hn::Mul(pad, hn::Abs(reciprocal));
  const auto bounded = hn::Le(pad, hn::Set(w, scale.largest_pad));
  const WideVector all = hn::Set(w, double{pass_all});
  hn::Store(hn::DemoteTo(d, hn::IfThenElse(bounded, hn::Sub(centre, width), hn::Neg(all))), d, out.near_offset);
  hn::Store(hn::DemoteTo(d, hn::IfThenElse(bounded, hn::Add(centre, width), all)), d, out.far_offset);

  const AxisWords u;
  alignas(16) static constexpr uint32_t rows[] = {0, 16, 32, 0};
  const auto side = hn::ShiftLeft<3>(hn::ShiftRight<31>(hn::BitCast(u, narrow_direction)));
  hn::Store(hn::Add(hn::Load(u, rows), side), u, out.near_row);

  alignas(32) double magnitudes[4];
  hn::Store(magnitude, w, magnitudes);
  prepare_shear_lanes(out, magnitudes[out.axis[2]], scale.direction);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
