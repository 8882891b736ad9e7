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
#include <rayloom/accel/simd/mask_bits-inl.h>

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

/// What all rays share of a structure's bounds; see prepare_ray().
struct BoundsLanes {
  /// The header's bounds are followed by other members, so whole vectors may be read.
  HWY_INLINE BoundsLanes(const StructureHeader& of, float scale)
      : low(load_axes(of.bounds_min)),
        high(load_axes(of.bounds_max)),
        size(hn::Max(hn::Abs(low), hn::Abs(high))),
        transform_pad(transform_pad_of(scale)),
        pad_scale(scale),
        header(&of) {}

  hn::Vec<Axes> low, high, size;
  float transform_pad, pad_scale;
  const StructureHeader* header;
};

/// Whether a ray is traceable and moderate: moderate_scale() is for it. `longest`: of the direction's magnitudes.
HWY_INLINE bool moderate(const Ray& ray, hn::Vec<Axes> size, hn::Vec<Axes> magnitude, float longest) {
  const Axes d;
  const auto small =
      hn::And(hn::Lt(size, hn::Set(d, largest_moderate)), hn::Le(magnitude, hn::Set(d, longest_moderate)));
  return hn::AllTrue(d, small) & (longest >= shortest_moderate) & (ray.t_min >= 0) & (ray.t_min <= ray.t_max);
}

/// PreparedRay's axes, and what follows from them. `longest` is one of `magnitude`.
HWY_INLINE void prepare_axes(hn::Vec<Axes> origin, hn::Vec<Axes> direction, hn::Vec<Axes> magnitude, float longest,
                             PreparedRay& out) {
  alignas(16) static constexpr uint32_t orders[3][4] = {{1, 2, 0, 0}, {2, 0, 1, 1}, {0, 1, 2, 2}};
  const Axes d;
  const auto equal = hn::Eq(magnitude, hn::Set(d, longest));
  const uint32_t* const order = orders[std::countr_zero(bits_of(d, equal))];
  const auto indices = hn::SetTableIndices(d, reinterpret_cast<const int32_t*>(order));
  const auto ordered = hn::TableLookupLanes(direction, indices);
  const auto shear = hn::Div(ordered, hn::Broadcast<2>(ordered));
  // Each store writes an element too many, which the next one mends.
  hn::StoreU(hn::Load(AxisWords(), order), AxisWords(), out.axis);
  hn::StoreU(hn::TableLookupLanes(origin, indices), d, out.ordered_origin);
  hn::StoreU(hn::LowerHalf(hn::FixedTag<float, 2>(), shear), hn::FixedTag<float, 2>(), out.shear);
}

/// See prepare_ray().
HWY_INLINE void prepare_lanes(const Ray& ray, const BoundsLanes& bounds, PreparedRay& out) {
  const Axes d;
  const hn::Vec<Axes> origin = load_axes(ray.origin), direction = load_axes(ray.direction);
  const hn::Vec<Axes> magnitude = hn::Abs(direction), size = hn::Max(hn::Abs(origin), bounds.size);
  const float longest = largest_lane(magnitude);
  if (HWY_UNLIKELY(!moderate(ray, size, magnitude, longest))) {
    out = prepare_ray(ray, bounds.header->bounds_min, bounds.header->bounds_max, bounds.pad_scale);
    return;
  }
  static_cast<Ray&>(out) = ray;
  out.valid = true;
  out.box_scale = 1;
  prepare_axes(origin, direction, magnitude, longest, out);

  const hn::Vec<Axes> reciprocal_size = hn::Div(hn::Set(d, 1.0f), hn::Max(magnitude, hn::Set(d, moderate_shortest)));
  const hn::Vec<Axes> reciprocal = hn::CopySign(reciprocal_size, direction);
  hn::Store(reciprocal, d, out.reciprocal);

  const hn::Vec<Axes> reach = hn::Max(hn::Abs(hn::Sub(bounds.low, origin)), hn::Abs(hn::Sub(bounds.high, origin)));
  const float largest = moderate_size(largest_lane(size));
  float common_pad = moderate_pad(largest);
  if (HWY_UNLIKELY(bounds.transform_pad > 0)) common_pad += bounds.transform_pad * largest_lane(reach);
  const hn::Vec<Axes> pad =
      hn::Add(hn::Mul(hn::Set(d, 4 * float_unit), hn::Add(reach, hn::Abs(origin))), hn::Set(d, common_pad));
  const hn::Vec<Axes> centre = hn::Mul(hn::Neg(origin), reciprocal), width = hn::Mul(pad, reciprocal_size);
  const auto bounded = hn::Le(pad, hn::Set(d, largest));
  const hn::Vec<Axes> all = hn::Set(d, pass_all);
  hn::Store(hn::IfThenElse(bounded, hn::Sub(centre, width), hn::Neg(all)), d, out.near_offset);
  hn::Store(hn::IfThenElse(bounded, hn::Add(centre, width), all), d, out.far_offset);

  const AxisWords u;
  alignas(16) static constexpr uint32_t rows[] = {0, 16, 32, 0};
  const auto side = hn::ShiftLeft<3>(hn::ShiftRight<31>(hn::BitCast(u, direction)));
  hn::Store(hn::Add(hn::Load(u, rows), side), u, out.near_row);
}

/// See object_ray(). The two halves of the result are stored as vectors: loads of vectors need not wait for them.
HWY_INLINE void object_ray_lanes(const InstanceRecord& instance, const Ray& ray, Ray& out) {
  const Axes d;
  const WideAxes w;
  const auto x = hn::Load(w, instance.world_to_object[0]), y = hn::Load(w, instance.world_to_object[1]);
  const auto z = hn::Load(w, instance.world_to_object[2]);
  const auto even = hn::InterleaveLower(w, x, y), odd = hn::InterleaveUpper(w, x, y);
  const auto even_z = hn::InterleaveLower(w, z, z), odd_z = hn::InterleaveUpper(w, z, z);
  const auto column0 = hn::ConcatLowerLower(w, even_z, even), column1 = hn::ConcatLowerLower(w, odd_z, odd);
  const auto column2 = hn::ConcatUpperUpper(w, even_z, even);
  const auto transform = [&](double a, double b, double c) HWY_ATTR {
    const auto sum = hn::Add(hn::Mul(column0, hn::Set(w, a)), hn::Mul(column1, hn::Set(w, b)));
    return hn::DemoteTo(d, hn::Add(sum, hn::Mul(column2, hn::Set(w, c))));
  };
  const auto from = [&](int k) { return double{ray.origin[k]} - double{instance.object_to_world[k][3]}; };
  const auto three = hn::FirstN(d, 3);
  const auto origin = transform(from(0), from(1), from(2));
  const auto direction = transform(double{ray.direction[0]}, double{ray.direction[1]}, double{ray.direction[2]});
  hn::StoreU(hn::IfThenElse(three, origin, hn::LoadU(d, ray.origin)), d, out.origin);
  hn::StoreU(hn::IfThenElse(three, direction, hn::LoadU(d, ray.direction)), d, out.direction);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
