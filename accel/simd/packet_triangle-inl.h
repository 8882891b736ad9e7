// Exact hits of a packet: the determinants of triangle.cpp in vectors of doubles. Rays that these leave undecided go to
// triangle.h one by one. Proofs: docs/numerics.md, "Packets". Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_
#undef RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/packet_corners-inl.h>
#include <rayloom/accel/simd/packet_filter-inl.h>
#include <rayloom/accel/triangle_determinants.h>

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// t, u and v of half a packet, and the rays for which they are the exact ones rounded.
struct HalfHits {
  HalfVector t, u, v;
  uint32_t known = 0, front = 0;
};

/// What depends on no direction: with p = v0 - o, the vectors whose products with a direction are
/// the determinants of triangle_determinants.h, the depth, and the errors of DeterminantErrors.
struct PacketTriangle {
  HWY_INLINE PacketTriangle(const PencilRays& rays, const DoubleVector3& v0, const DoubleVector3& v1,
                            const DoubleVector3& v2) {
    const PacketDoubles d;
    const DoubleVector3 point = subtract(v0, splat(rays.common_origin));
    const DoubleVector3 edge1 = subtract(v1, v0), edge2 = subtract(v2, v0);
    area = cross(edge1, edge2);
    u = cross(edge2, point);
    v = cross(point, edge1);
    depth = dot(area, point);

    const DoubleVector rounding = hn::Set(d, 8 * double_unit);
    const DoubleVector length1 = absolute_sum(edge1), length2 = absolute_sum(edge2);
    const DoubleVector reach = hn::Mul(rounding, hn::Add(absolute_sum(point), hn::Add(length1, length2)));
    const DoubleVector edges = hn::Mul(length1, length2);
    area_error = hn::Mul(rounding, edges);
    u_error = hn::Mul(reach, length2);
    v_error = hn::Mul(reach, length1);
    depth_error = hn::MulAdd(hn::Mul(hn::Set(d, 3.0), edges), reach, hn::Mul(rounding, hn::Abs(depth)));
  }

  DoubleVector3 area, u, v;
  DoubleVector depth;
  DoubleVector area_error, u_error, v_error;  ///< for a direction whose dominant component is 1
  DoubleVector depth_error;
};

/// The float that both ends of an interval around a quotient round to; `known` loses rays of which they differ.
HWY_INLINE HalfVector round_quotient(DoubleVector numerator, DoubleVector error, DoubleVector inverse,
                                     hn::Mask<HalfFloats>& known) {
  const HalfFloats narrow;
  const HalfVector low = hn::DemoteTo(narrow, hn::Mul(hn::Sub(numerator, error), inverse));
  const HalfVector high = hn::DemoteTo(narrow, hn::Mul(hn::Add(numerator, error), inverse));
  known = hn::And(known, hn::Eq(low, high));
  return hn::Add(low, hn::Zero(narrow));
}

/// The quotients of triangle.cpp, for certain hits.
template <int half>
HWY_INLINE HalfHits hit_half(const PencilRays& rays, size_t r, const PacketTriangle& triangle) {
  const PacketDoubles d;
  const HalfFloats narrow;
  const DoubleVector3 direction = promote_half<half>(rays.row[r].direction);
  const DoubleVector longest = promote_half<half>(rays.frame[r].longest);
  const DoubleVector area = dot(triangle.area, direction);
  const DoubleVector u = dot(triangle.u, direction), v = dot(triangle.v, direction);
  const DoubleVector area_part = hn::Mul(hn::Set(d, 8 * double_unit), hn::Abs(area));
  const DoubleVector u_error = hn::MulAdd(longest, triangle.u_error, area_part);
  const DoubleVector v_error = hn::MulAdd(longest, triangle.v_error, area_part);

  // Where the area's sign is not known the quotients become NaN, which is not equal to itself.
  const auto sure = hn::Gt(hn::Abs(area), hn::Mul(longest, triangle.area_error));
  const DoubleVector inverse = hn::IfThenElse(sure, hn::Div(hn::Set(d, 1.0), area), hn::NaN(d));
  HalfHits hits;
  hn::Mask<HalfFloats> known = hn::FirstN(narrow, packet_size / 2);
  hits.t = round_quotient(triangle.depth, triangle.depth_error, inverse, known);
  hits.u = round_quotient(u, u_error, inverse, known);
  hits.v = round_quotient(v, v_error, inverse, known);
  hits.known = bits_of(narrow, known);
  hits.front = bits_of(d, hn::Lt(area, hn::Zero(d)));
  return hits;
}

struct PacketHits {
  PacketVector t, u, v;
  uint32_t known, front;
};

template <int half, class Corners>
HWY_INLINE PacketTriangle triangle_of(const PencilRays& rays, const Corners& corners) {
  return {rays, corners.template corner<half>(0), corners.template corner<half>(1), corners.template corner<half>(2)};
}

/// Hits of the rays `wanted` of a row, which hit triangles of these corners for certain.
template <class Corners>
HWY_INLINE PacketHits hit_triangles(const PencilRays& rays, size_t r, const Corners& corners, uint32_t wanted) {
  constexpr uint32_t half_size = packet_size / 2, low_rays = (1u << half_size) - 1;
  const PacketFloats d;
  const HalfVector none = hn::Zero(HalfFloats());
  HalfHits low{none, none, none}, high = low;
  if constexpr (std::is_same_v<Corners, CommonCorners>) {
    const PacketTriangle triangle = triangle_of<0>(rays, corners);
    if (wanted & low_rays) low = hit_half<0>(rays, r, triangle);
    if (wanted & ~low_rays) high = hit_half<1>(rays, r, triangle);
  } else {
    if (wanted & low_rays) low = hit_half<0>(rays, r, triangle_of<0>(rays, corners));
    if (wanted & ~low_rays) high = hit_half<1>(rays, r, triangle_of<1>(rays, corners));
  }
  return {hn::Combine(d, high.t, low.t), hn::Combine(d, high.u, low.u), hn::Combine(d, high.v, low.v),
          low.known | high.known << half_size, low.front | high.front << half_size};
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
