// A leaf against the rays of a packet: a float filter, a float test of t, and the determinants of triangle.cpp in
// vectors of doubles. Rays that these leave undecided go to triangle.h one by one. Proofs:
// docs/numerics.md, "Packets". Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_
#undef RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_TRIANGLE_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/pencil_rays-inl.h>
#include <rayloom/accel/triangle_determinants.h>

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// An edge's function for a ray of slopes (p, q) is constant + p * by_x + q * by_y.
struct PacketEdge {
  HWY_INLINE PacketEdge(const ShearedVertex& a, const ShearedVertex& b)
      : constant(hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))),
        by_x(hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y))),
        by_y(hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z))) {}

  FloatLanes constant, by_x, by_y;
};

/// What the rays share of the triangles of a leaf: edge functions, a bound on their errors, depths.
struct alignas(64) PacketLeaf {
  /// Also returns the triangles that some of the rays may hit at a depth of at most `deepest`.
  HWY_INLINE uint32_t load(const PencilRays& rays, const TriangleLeaf& leaf, FloatLanes deepest) {
    const Floats d;
    const auto [a, b, c] = shear_triangles(rays.middle, load_triangles(leaf, rays.middle.axis));
    const FloatLanes reach = hn::Max(hn::Max(hn::Abs(a.z), hn::Abs(b.z)), hn::Abs(c.z));
    const FloatLanes extent = hn::Add(hn::Add(a.extent(), b.extent()), c.extent());
    const FloatLanes lateral = hn::Mul(hn::MulAdd(hn::Set(d, 2.25f), extent, hn::Mul(hn::Set(d, 5), reach)), extent);
    const FloatLanes angles = hn::MulAdd(hn::Set(d, 9), hn::Add(rays.widest[0], rays.widest[1]), hn::Set(d, 0x1p-20f));
    const FloatLanes sum = hn::MulAdd(hn::Mul(angles, reach), reach, lateral);
    const FloatLanes error = hn::MulAdd(sum, hn::Set(d, 0x1p-24f), hn::Set(d, 0x1p-126f));
    const PacketEdge ab(a, b), bc(b, c), ca(c, a);
    store(0, ab, c);
    store(1, bc, a);
    store(2, ca, b);
    hn::Store(error, d, bound);
    hn::Store(reach, d, depth);

    const FloatLanes sign = hn::Set(d, rays.sign);
    const FloatLanes za = hn::Xor(a.z, sign), zb = hn::Xor(b.z, sign), zc = hn::Xor(c.z, sign);
    const LaneMask before = hn::Lt(hn::Max(hn::Max(za, zb), zc), hn::Zero(d));
    const LaneMask beyond = hn::Gt(hn::Min(hn::Min(za, zb), zc), deepest);
    const LaneMask outside = missed_by_all(rays, error, ab, bc, ca);
    return leaf.used_mask() & ~mask_bits(hn::Or(outside, hn::Or(before, beyond)));
  }

  alignas(32) float constant[3][8], by_x[3][8], by_y[3][8];  ///< of edges 01, 12, 20
  alignas(32) float opposite[3][8];                          ///< z of the vertex that the edge does not have
  alignas(32) float bound[8], depth[8];                      ///< `depth`: largest |z|

 private:
  HWY_INLINE void store(int i, const PacketEdge& edge, const ShearedVertex& vertex) {
    const Floats d;
    hn::Store(edge.constant, d, constant[i]);
    hn::Store(edge.by_x, d, by_x[i]);
    hn::Store(edge.by_y, d, by_y[i]);
    hn::Store(vertex.z, d, opposite[i]);
  }

  /// Whether one edge function is positive and another negative for every slope of the packet.
  static HWY_INLINE LaneMask missed_by_all(const PencilRays& rays, FloatLanes error, const PacketEdge& ab,
                                           const PacketEdge& bc, const PacketEdge& ca) {
    const auto spread = [&](const PacketEdge& edge) HWY_ATTR {
      return hn::MulAdd(rays.widest[0], hn::Abs(edge.by_x), hn::MulAdd(rays.widest[1], hn::Abs(edge.by_y), error));
    };
    const FloatLanes s0 = spread(ab), s1 = spread(bc), s2 = spread(ca);
    const auto positive = hn::Or(hn::Gt(ab.constant, s0), hn::Or(hn::Gt(bc.constant, s1), hn::Gt(ca.constant, s2)));
    const auto negative = hn::Or(hn::Lt(ab.constant, hn::Neg(s0)),
                                 hn::Or(hn::Lt(bc.constant, hn::Neg(s1)), hn::Lt(ca.constant, hn::Neg(s2))));
    return hn::And(positive, negative);
  }
};

/// Which rays the triangle is undecided for, and which it is certainly hit by at a t that may be in range.
struct PacketMasks {
  uint32_t undecided, certain;
};

struct PacketEdges {
  HWY_INLINE PacketEdges(const PencilRays::Frame& frame, const PacketLeaf& leaf, uint32_t lane) {
    for (int i = 0; i < 3; ++i)
      edge[i] = hn::MulAdd(frame.slope[0], splat(leaf.by_x[i][lane]),
                           hn::MulAdd(frame.slope[1], splat(leaf.by_y[i][lane]), splat(leaf.constant[i][lane])));
  }
  PacketVector edge[3];
};

/// Rays whose rounded t may lie in (t_min, t_far], of those for which the triangle is certainly hit. With
/// D = E12 z0 + E20 z1 + E01 z2, whose error is below `error`, t |d_z| = D / A.
HWY_INLINE PacketMask may_be_in_range(const PencilRays& rays, size_t r, const PacketEdges& edges,
                                      const PacketLeaf& leaf, uint32_t lane, PacketVector t_far) {
  const PacketVector signed_area = hn::Add(hn::Add(edges.edge[0], edges.edge[1]), edges.edge[2]);
  PacketVector sum = hn::Mul(edges.edge[0], splat(leaf.opposite[0][lane]));
  for (int i = 1; i < 3; ++i) sum = hn::MulAdd(edges.edge[i], splat(leaf.opposite[i][lane]), sum);
  const PacketVector area = hn::Abs(signed_area);
  const PacketVector flip = hn::And(hn::Xor(signed_area, splat(rays.sign)), splat(-0.0f));
  const PacketVector distance = hn::Xor(sum, flip);
  const PacketVector margin = splat(4 * leaf.bound[lane]);
  const PacketVector error =
      hn::MulAdd(splat(leaf.depth[lane]), hn::MulAdd(area, splat(0x1p-21f), margin), splat(0x1p-120f));
  const PacketVector first = hn::Mul(hn::Mul(rays.row[r].t_min, rays.frame[r].longest), splat(1 - 0x1p-18f));
  const PacketVector from = hn::IfThenElseZero(hn::Ge(first, splat(0x1p-60f)), first);
  const PacketVector to = hn::Max(hn::Mul(hn::Mul(t_far, rays.frame[r].longest), splat(1 + 0x1p-18f)), splat(0x1p-60f));
  const PacketMask before = hn::Lt(hn::Add(distance, error), hn::Mul(from, hn::Sub(area, margin)));
  const PacketMask beyond = hn::Gt(hn::Sub(distance, error), hn::Mul(to, hn::Add(area, margin)));
  return hn::Not(hn::Or(before, beyond));
}

/// One triangle of the leaf and one row of rays.
HWY_INLINE PacketMasks test_triangle(const PencilRays& rays, size_t r, const PacketLeaf& leaf, uint32_t lane,
                                     uint32_t active, PacketVector t_far) {
  const PacketEdges edges(rays.frame[r], leaf, lane);
  const PacketVector bound = splat(leaf.bound[lane]), below = splat(-leaf.bound[lane]);
  const PacketVector low = hn::Min(hn::Min(edges.edge[0], edges.edge[1]), edges.edge[2]);
  const PacketVector high = hn::Max(hn::Max(edges.edge[0], edges.edge[1]), edges.edge[2]);
  const uint32_t possible = active & ~packet_bits(hn::And(hn::Gt(high, bound), hn::Lt(low, below)));
  if (possible == 0) return {0, 0};
  const uint32_t hit = packet_bits(hn::Or(hn::Gt(low, bound), hn::Lt(high, below)));
  return {possible & ~hit, possible & hit & packet_bits(may_be_in_range(rays, r, edges, leaf, lane, t_far))};
}

/// The corners of one triangle, for all rays.
struct CommonCorners {
  HWY_INLINE CommonCorners(const TriangleLeaf& leaf, uint32_t lane) {
    for (uint32_t corner = 0; corner < 3; ++corner)
      for (uint32_t k = 0; k < 3; ++k) at_[corner][k] = leaf.coordinate(corner, k, lane);
  }
  template <int half>
  HWY_INLINE DoubleVector3 corner(int i) const {
    return splat(at_[i]);
  }

 private:
  float at_[3][3];
};

/// Sixteen floats, one for each ray; indices are taken modulo sixteen.
HWY_INLINE PacketVector look_up_sixteen(const float* table, PacketWordVector index) {
#if HWY_TARGET == HWY_AVX3
  return PacketVector{_mm512_permutexvar_ps(index.raw, hn::LoadU(PacketFloats(), table).raw)};
#else
  return look_up(hn::LoadU(Floats(), table), hn::LoadU(Floats(), table + 8), index);
#endif
}

/// One of eight words for each ray.
HWY_INLINE PacketWordVector look_up_eight(WordLanes table, PacketWordVector index) {
#if HWY_TARGET == HWY_AVX3
  return PacketWordVector{_mm512_permutexvar_epi32(index.raw, hn::ZeroExtendVector(PacketWords(), table).raw)};
#else
  return PacketWordVector{_mm256_permutevar8x32_epi32(table.raw, index.raw)};
#endif
}

/// The corners of a triangle of each ray's own, all of one leaf.
struct OwnCorners {
  HWY_INLINE OwnCorners(const TriangleLeaf& leaf, PacketWordVector lane) {
    const size_t third = third_vertices(leaf);
    for (size_t i = 0; i < 3; ++i) {
      const auto corners = hn::PromoteTo(Words(), hn::LoadU(hn::FixedTag<uint8_t, 8>(), leaf.corner[i]));
      const PacketWordVector index = look_up_eight(corners, lane);
      for (uint32_t k = 0; k < 3; ++k) at_[i][k] = look_up_sixteen(leaf.row(k) + (i == 2 ? third : 0), index);
    }
  }
  template <int half>
  HWY_INLINE DoubleVector3 corner(int i) const {
    return promote_half<half>(at_[i]);
  }

 private:
  PacketVector at_[3][3];
};

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
