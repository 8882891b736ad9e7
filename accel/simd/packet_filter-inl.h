// A leaf against the rays of a packet, in float: which rays a triangle is certainly hit by, which it is undecided for.
// Proofs: docs/numerics.md, "Packets". Re-included once per target as lanes-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_FILTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_FILTER_INL_H_
#undef RAYLOOM_ACCEL_PACKET_FILTER_INL_H_
#else
#define RAYLOOM_ACCEL_PACKET_FILTER_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/pencil_rays-inl.h>

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

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
