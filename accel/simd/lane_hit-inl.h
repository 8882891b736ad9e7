// The hit of a ray with one triangle of a leaf that it certainly hits, one lane a coordinate and then one a
// determinant. What doubles leave undecided goes to refined_triangle.h, so the bits are those of triangle_hit.h.
// Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_LANE_HIT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_LANE_HIT_INL_H_
#undef RAYLOOM_ACCEL_LANE_HIT_INL_H_
#else
#define RAYLOOM_ACCEL_LANE_HIT_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/lanes-inl.h>
#include <rayloom/accel/simd/prepare-inl.h>
#include <rayloom/accel/triangle_hit.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

using Coordinates = hn::Vec<WideAxes>;

/// Lanes a, b, c and d of a vector.
template <int a, int b, int c, int d>
HWY_INLINE Coordinates choose(Coordinates v) {
  return Coordinates{_mm256_permute4x64_pd(v.raw, a | b << 2 | c << 4 | d << 6)};
}

HWY_INLINE Coordinates corner_of(const TriangleLeaf& leaf, uint32_t vertex, uint32_t lane) {
  const float* const x = leaf.row(0) + leaf.corner[vertex][lane];
  const float *const y = x + leaf.slots, *const z = y + leaf.slots;
  return hn::PromoteTo(WideAxes(), hn::Vec<Axes>{_mm_setr_ps(*x, *y, *z, 0)});
}

/// Components z, x, y of the cross product, given both factors as they are and as y, z, x.
HWY_INLINE Coordinates cross_zxy(Coordinates a, Coordinates a_yzx, Coordinates b, Coordinates b_yzx) {
  return hn::MulSub(a, b_yzx, hn::Mul(a_yzx, b));
}

/// The sums of the three lowest lanes of each.
HWY_INLINE Coordinates sums_of_three(Coordinates a, Coordinates b, Coordinates c, Coordinates d) {
  const WideAxes w;
  const auto low_ab = hn::InterleaveLower(w, a, b), low_cd = hn::InterleaveLower(w, c, d);
  const auto two_ab = hn::Add(low_ab, hn::InterleaveUpper(w, a, b));
  const auto two_cd = hn::Add(low_cd, hn::InterleaveUpper(w, c, d));
  return hn::Add(hn::ConcatLowerLower(w, two_cd, two_ab), hn::ConcatUpperUpper(w, low_cd, low_ab));
}

/// Depth, u, v and area of triangle_determinants.h, and what is added to their errors to cover the division.
struct LaneDeterminants {
  HWY_INLINE LaneDeterminants(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane) {
    const Axes f;
    const WideAxes w;
    const Coordinates v0 = corner_of(leaf, 0, lane), point = hn::Sub(v0, hn::PromoteTo(w, load_axes(ray.origin)));
    const Coordinates edge1 = hn::Sub(corner_of(leaf, 1, lane), v0), edge2 = hn::Sub(corner_of(leaf, 2, lane), v0);
    const Coordinates edge1_yzx = choose<1, 2, 0, 3>(edge1), edge2_yzx = choose<1, 2, 0, 3>(edge2);
    const Coordinates point_yzx = choose<1, 2, 0, 3>(point), point_zxy = choose<2, 0, 1, 3>(point);
    const Coordinates direction_zxy = choose<2, 0, 1, 3>(hn::PromoteTo(w, load_axes(ray.direction)));

    const Coordinates normal = cross_zxy(edge1, edge1_yzx, edge2, edge2_yzx);
    value = sums_of_three(
        hn::Mul(normal, point_zxy), hn::Mul(cross_zxy(edge2, edge2_yzx, point, point_yzx), direction_zxy),
        hn::Mul(cross_zxy(point, point_yzx, edge1, edge1_yzx), direction_zxy), hn::Mul(normal, direction_zxy));

    const Coordinates rounding = hn::Set(w, 8 * double_unit);
    const Coordinates size1 = hn::Abs(edge1), size2 = hn::Abs(edge2), size0 = hn::Abs(point);
    const Coordinates lengths = sums_of_three(size1, size2, size0, size0);
    const Coordinates length1 = choose<0, 0, 0, 0>(lengths), length2 = choose<1, 1, 1, 1>(lengths);
    const Coordinates reach = hn::Mul(rounding, hn::Add(choose<2, 2, 2, 2>(lengths), hn::Add(length1, length2)));
    const Coordinates longest = hn::PromoteTo(w, hn::Abs(hn::Set(f, ray.direction[ray.axis[2]])));
    const Coordinates edges = hn::Mul(length1, length2);
    const Coordinates factors = blend<0b1001>(choose<1, 1, 0, 0>(lengths), edges);
    const Coordinates scale = blend<0b0001>(longest, hn::Set(w, 3.0));
    const Coordinates division = hn::Mul(rounding, choose<0, 3, 3, 3>(hn::Abs(value)));
    error = hn::MulAdd(hn::Mul(factors, scale), blend<0b1000>(reach, rounding), division);
  }

  /// Lanes of `b` where the mask has a bit.
  template <int mask>
  static HWY_INLINE Coordinates blend(Coordinates a, Coordinates b) {
    return Coordinates{_mm256_blend_pd(a.raw, b.raw, mask)};
  }

  Coordinates value, error;
};

[[gnu::noinline]] inline std::optional<TriangleHit> refine_lane(const PreparedRay& ray, const TriangleLeaf& leaf,
                                                                uint32_t lane, float t_far) {
  float v[3][3];
  for (uint32_t vertex = 0; vertex < 3; ++vertex)
    for (uint32_t axis = 0; axis < 3; ++axis) v[vertex][axis] = leaf.coordinate(vertex, axis, lane);
  TriangleEffort effort;
  return refined_hit(ray, {{v[0], v[1], v[2]}}, t_far, true, effort);
}

/// See hit_of<true>().
HWY_INLINE std::optional<TriangleHit> hit_lane(const PreparedRay& ray, const TriangleLeaf& leaf, uint32_t lane,
                                               float t_far) {
  const Axes f;
  const WideAxes w;
  const LaneDeterminants determinants(ray, leaf, lane);
  const Coordinates area = choose<3, 3, 3, 3>(determinants.value);
  const Coordinates inverse = hn::Div(hn::Set(w, 1.0), area);
  const auto low = hn::DemoteTo(f, hn::Mul(hn::Sub(determinants.value, determinants.error), inverse));
  const auto high = hn::DemoteTo(f, hn::Mul(hn::Add(determinants.value, determinants.error), inverse));
  constexpr int quotients = 0b0111, sign = 0b1000;
  const int equal = _mm_movemask_ps(_mm_cmpeq_ps(low.raw, high.raw));
  const int sure = _mm256_movemask_pd(_mm256_cmp_pd(hn::Abs(area).raw, determinants.error.raw, _CMP_GT_OQ));
  if (HWY_UNLIKELY(((equal & quotients) | (sure & sign)) != (quotients | sign)))
    return refine_lane(ray, leaf, lane, t_far);
  const auto result = hn::Add(low, hn::Zero(f));
  const float t = hn::GetLane(result);
  if (!in_range(ray, t, t_far)) return std::nullopt;
  return TriangleHit{t, hn::GetLane(hn::Broadcast<1>(result)), hn::GetLane(hn::Broadcast<2>(result)),
                     hn::GetLane(area) < 0};
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
