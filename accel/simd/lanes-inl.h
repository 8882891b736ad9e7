// The lane tests in vectors of eight floats, re-included once per target by Highway's foreach_target.h. They compute
// what lanes_scalar.h computes, operation by operation, so every bit of their results is equal. Targets: AVX2 and AVX3
// (AVX-512, on 256-bit vectors); the includer disables the others and guards its own code in the same way.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_LANES_INL_H_
#undef RAYLOOM_ACCEL_LANES_INL_H_
#else
#define RAYLOOM_ACCEL_LANES_INL_H_
#endif
// clang-format on

#include <rayloom/accel/depth_interval.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/simd/lane_masks.h>
#include <rayloom/accel/simd/mask_bits-inl.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::FixedTag<float, 8>;
using Words = hn::FixedTag<uint32_t, 8>;
using FloatLanes = hn::Vec<Floats>;
using Ints = hn::FixedTag<int32_t, 8>;
using WordLanes = hn::Vec<Words>;
using IntLanes = hn::Vec<Ints>;
using LaneMask = hn::Mask<Floats>;

/// What box tests read of a ray. Row offsets count floats from the start of a node's or leaf's planes.
struct BoxLanes {
  HWY_INLINE explicit BoxLanes(const PreparedRay& ray) {
    const Floats d;
    for (int k = 0; k < 3; ++k) {
      reciprocal[k] = hn::Set(d, ray.reciprocal[k]);
      near_offset[k] = hn::Set(d, ray.near_offset[k]);
      far_offset[k] = hn::Set(d, ray.far_offset[k]);
      near_row[k] = ray.near_row[k];
      far_row[k] = ray.far_row(k);
    }
  }

  FloatLanes reciprocal[3], near_offset[3], far_offset[3];
  size_t near_row[3], far_row[3];
};

/// What triangle tests read of a ray, in the order of PreparedRay::axis.
struct TriangleLanes {
  TriangleLanes() = default;
  HWY_INLINE explicit TriangleLanes(const PreparedRay& ray) {
    const Floats d;
    for (int k = 0; k < 3; ++k) {
      origin[k] = hn::Set(d, ray.ordered_origin[k]);
      axis[k] = ray.axis[k];
    }
    for (int i = 0; i < 2; ++i) shear[i] = hn::Set(d, ray.shear[i]);
  }

  FloatLanes origin[3], shear[2];
  uint32_t axis[3];
};

HWY_INLINE uint32_t mask_bits(LaneMask mask) { return bits_of(Floats(), mask); }

HWY_INLINE LaneMask used_lanes(const uint32_t* primitive) {
  return hn::RebindMask(Floats(), hn::Ne(hn::Load(Words(), primitive), hn::Set(Words(), no_index)));
}

/// Entry and exit of eight boxes, clipped to [t_near, t_far]; entry > exit: missed. See scalar::BoxInterval.
struct BoxIntervals {
  IntLanes entry, exit;
  HWY_INLINE LaneMask met() const {
#if HWY_TARGET == HWY_AVX3
    return LaneMask::FromBits(_mm256_cmple_epi32_mask(entry.raw, exit.raw));
#else
    return hn::RebindMask(Floats(), hn::Not(hn::Gt(entry, exit)));
#endif
  }
};

HWY_INLINE IntLanes planes_crossed(const float* planes, FloatLanes reciprocal, FloatLanes offset) {
  return hn::BitCast(Ints(), hn::MulAdd(hn::Load(Floats(), planes), reciprocal, offset));
}

HWY_INLINE BoxIntervals box_intervals(const BoxLanes& ray, const float* planes, float t_near, float t_far) {
  const Floats d;
  IntLanes entry[3], exit[3];
  for (int k = 0; k < 3; ++k) {
    entry[k] = planes_crossed(planes + ray.near_row[k], ray.reciprocal[k], ray.near_offset[k]);
    exit[k] = planes_crossed(planes + ray.far_row[k], ray.reciprocal[k], ray.far_offset[k]);
  }
  const IntLanes near = hn::BitCast(Ints(), hn::Set(d, t_near)), far = hn::BitCast(Ints(), hn::Set(d, t_far));
  return {hn::Max(hn::Max(entry[0], entry[1]), hn::Max(entry[2], near)),
          hn::Min(hn::Min(exit[0], exit[1]), hn::Min(exit[2], far))};
}

/// See scalar::NodeHits. A key is a rounded entry distance, which is not negative, with the lane in its low bits.
struct NodeHits {
  uint32_t mask;
  LaneMask lanes;  ///< the same
  WordLanes keys;
  HWY_INLINE void store_near(float (&out)[8]) const {
    hn::StoreU(hn::BitCast(Floats(), hn::And(keys, hn::Set(Words(), ~7u))), Floats(), out);
  }
};

/// See scalar::test_node().
HWY_INLINE NodeHits test_node(const BoxLanes& ray, const Node8& node, float t_near, float t_far) {
  const Words w;
  const BoxIntervals intervals = box_intervals(ray, &node.bounds[0][0][0], t_near, t_far);
  const WordLanes rounded = hn::And(hn::BitCast(w, intervals.entry), hn::Set(w, ~7u));
  const LaneMask met = intervals.met();
  return {mask_bits(met), met, hn::Or(rounded, hn::Iota(w, 0))};
}

/// See scalar::test_boxes().
HWY_INLINE uint32_t test_boxes(const BoxLanes& ray, const ProceduralLeaf8& leaf, float t_near, float t_far) {
  const BoxIntervals intervals = box_intervals(ray, &leaf.bounds[0][0][0], t_near, t_far);
  return mask_bits(hn::And(intervals.met(), used_lanes(leaf.primitive)));
}

/// One vertex of eight triangles in the ray's sheared frame.
struct ShearedVertex {
  FloatLanes x, y, z;
  HWY_INLINE FloatLanes extent() const { return hn::Add(hn::Abs(x), hn::Abs(y)); }
};

HWY_INLINE ShearedVertex shear_vertex(const TriangleLanes& ray, FloatLanes x, FloatLanes y, FloatLanes z) {
  z = hn::Sub(z, ray.origin[2]);
  return {hn::NegMulAdd(ray.shear[0], z, hn::Sub(x, ray.origin[0])),
          hn::NegMulAdd(ray.shear[1], z, hn::Sub(y, ray.origin[1])), z};
}

/// Eight entries of a table of sixteen floats; indices are taken modulo sixteen.
HWY_INLINE FloatLanes look_up(FloatLanes low, FloatLanes high, WordLanes index) {
#if HWY_TARGET == HWY_AVX3
  return FloatLanes{_mm256_permutex2var_ps(low.raw, index.raw, high.raw)};
#else
  const Floats d;
  const auto in_high = hn::MaskFromVec(hn::BitCast(d, hn::ShiftLeft<28>(index)));  // bit 3 to the sign
  return hn::IfThenElse(in_high, FloatLanes{_mm256_permutevar8x32_ps(high.raw, index.raw)},
                        FloatLanes{_mm256_permutevar8x32_ps(low.raw, index.raw)});
#endif
}

/// One vertex of eight triangles, coordinates in the order of a ray's axes.
struct LeafVertex {
  FloatLanes x, y, z;
};

/// From the rows of a table.
HWY_INLINE LeafVertex look_up_vertex(const float* x, const float* y, const float* z, const uint8_t* corner) {
  const Floats d;
  const WordLanes index = hn::PromoteTo(Words(), hn::LoadU(hn::FixedTag<uint8_t, 8>(), corner));
  return {look_up(hn::LoadU(d, x), hn::LoadU(d, x + 8), index), look_up(hn::LoadU(d, y), hn::LoadU(d, y + 8), index),
          look_up(hn::LoadU(d, z), hn::LoadU(d, z + 8), index)};
}

/// The triangles of a leaf, whatever way they are stored.
struct LeafTriangles {
  LeafVertex a, b, c;
  uint32_t used;
};

/// Where third vertices begin: those of plain leaves are the entries from 16 on, everything else lies in the first 16.
HWY_INLINE size_t third_vertices(const TriangleLeaf& leaf) {
  static_assert(TriangleLeaf::table_slots == 16 && TriangleLeaf::plain_slots == 24);
  return leaf.slots & (leaf.slots << 1) & 16;
}

HWY_INLINE LeafTriangles load_triangles(const TriangleLeaf& leaf, const uint32_t (&axis)[3]) {
  const float *const x = leaf.row(axis[0]), *const y = leaf.row(axis[1]), *const z = leaf.row(axis[2]);
  const size_t third = third_vertices(leaf);
  return {look_up_vertex(x, y, z, leaf.corner[0]), look_up_vertex(x, y, z, leaf.corner[1]),
          look_up_vertex(x + third, y + third, z + third, leaf.corner[2]), leaf.used_mask()};
}

/// The vertices of a leaf's triangles in the ray's sheared frame.
struct ShearedLeaf {
  ShearedVertex a, b, c;
};

HWY_INLINE ShearedLeaf shear_triangles(const TriangleLanes& ray, const LeafTriangles& of) {
  return {shear_vertex(ray, of.a.x, of.a.y, of.a.z), shear_vertex(ray, of.b.x, of.b.y, of.b.z),
          shear_vertex(ray, of.c.x, of.c.y, of.c.z)};
}

HWY_INLINE FloatLanes edge_function(const ShearedVertex& a, const ShearedVertex& b) {
  return hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x));
}

/// The bound of scalar::filter_triangle().
HWY_INLINE FloatLanes edge_bound(FloatLanes extent, FloatLanes depth) {
  const Floats d;
  const FloatLanes wide = hn::MulAdd(hn::Set(d, 0x1p-21f), depth, extent);
  const FloatLanes slope = hn::MulAdd(hn::Set(d, 1.625f), extent, hn::Mul(hn::Set(d, 3.125f), depth));
  return hn::MulAdd(hn::Mul(wide, slope), hn::Set(d, 0x1p-24f), hn::Set(d, 0x1p-126f));
}

/// Edge functions 01, 12 and 20 of triangles that a ray certainly hits, the depths of their vertices, and bounds.
template <class V>
struct CertainHits {
  V edge[3], z[3];  ///< z along the ray: times the sign of its dominant component
  V bound;          ///< on the errors of edge functions
  V depth;          ///< largest |z|
};

/// Depths of certain hits times the areas of their triangles, and these areas, each between two bounds.
template <class V>
struct DepthBounds {
  V low, high, least, most;
};

/// Not returned: GCC 12 copies a structure of vectors in halves, through memory.
template <class V>
HWY_INLINE void bound_depths(const CertainHits<V>& hits, DepthBounds<V>& bounds) {
  const hn::DFromV<V> d;
  const V signed_area = hn::Add(hn::Add(hits.edge[0], hits.edge[1]), hits.edge[2]);
  const V sum =
      hn::MulAdd(hits.edge[0], hits.z[2], hn::MulAdd(hits.edge[2], hits.z[1], hn::Mul(hits.edge[1], hits.z[0])));
  const V area = hn::Abs(signed_area), distance = hn::Xor(sum, hn::And(signed_area, hn::Set(d, -0.0f)));
  const V margin = hn::Mul(hn::Set(d, 4), hits.bound);
  const V reach = hn::Mul(hn::Mul(hn::Set(d, 2), hits.depth), area);
  const V error = hn::MulAdd(reach, hn::Set(d, 0x1p-22f), hn::MulAdd(hits.depth, margin, hn::Set(d, 0x1p-120f)));
  bounds.low = hn::Sub(distance, error);
  bounds.high = hn::Add(distance, error);
  bounds.least = hn::Sub(area, margin);
  bounds.most = hn::Add(area, margin);
}

template <class V>
struct DepthMasks {
  hn::Mask<hn::DFromV<V>> outside, inside;
};

/// How the depths of certain hits compare with a DepthInterval: see scalar::depth_of_hit().
template <class V>
HWY_INLINE DepthMasks<V> compare_depths(const DepthBounds<V>& depth, V outer_near, V outer_far, V inner_near,
                                        V inner_far) {
  const auto& [low, high, least, most] = depth;
  return {hn::Or(hn::Lt(high, hn::Mul(outer_near, least)), hn::Gt(low, hn::Mul(outer_far, most))),
          hn::And(hn::Gt(low, hn::Mul(inner_near, most)), hn::Lt(high, hn::Mul(inner_far, least)))};
}

/// See scalar::LeafDepths.
struct LeafDepths {
  FloatLanes low, most;
};

/// See scalar::depths_beyond().
HWY_INLINE uint32_t depths_beyond(const LeafDepths& depths, float outer_far) {
  return mask_bits(hn::Gt(depths.low, hn::Mul(hn::Set(Floats(), outer_far), depths.most)));
}

/// See scalar::store_nearest().
HWY_INLINE void store_nearest(const LeafDepths& depths, float (&nearest)[8]) {
  hn::StoreU(hn::Div(depths.low, depths.most), Floats(), nearest);
}

HWY_INLINE LeafMasks test_triangles(const TriangleLanes& ray, const LeafTriangles& triangles, const DepthLimits& depths,
                                    LeafDepths& found) {
  const Floats d;
  const auto [a, b, c] = shear_triangles(ray, triangles);
  const FloatLanes ab = edge_function(a, b), bc = edge_function(b, c), ca = edge_function(c, a);
  const FloatLanes sign = hn::Set(d, depths.sign);
  const FloatLanes az = hn::Xor(a.z, sign), bz = hn::Xor(b.z, sign), cz = hn::Xor(c.z, sign);
  const FloatLanes near = hn::Min(hn::Min(az, bz), cz), far = hn::Max(hn::Max(az, bz), cz);
  const FloatLanes extent = hn::Add(hn::Add(a.extent(), b.extent()), c.extent());
  const FloatLanes depth = hn::Max(far, hn::Neg(near)), bound = edge_bound(extent, depth);
  const FloatLanes below = hn::Neg(bound);

  // An edge function is NaN only if the bound is infinite or NaN, when no comparison holds; so the extremes may be
  // taken first.
  const FloatLanes low = hn::Min(hn::Min(ab, bc), ca), high = hn::Max(hn::Max(ab, bc), ca);
  const LaneMask missed = hn::And(hn::Gt(high, bound), hn::Lt(low, below));
  const LaneMask hit = hn::Or(hn::Gt(low, bound), hn::Lt(high, below));
  const FloatLanes outer_near = hn::Set(d, depths.outer_near), outer_far = hn::Set(d, depths.outer_far);
  const LaneMask outside = hn::Or(hn::Gt(near, outer_far), hn::Lt(far, outer_near));
  DepthBounds<FloatLanes> bounds;
  bound_depths<FloatLanes>({{ab, bc, ca}, {az, bz, cz}, bound, depth}, bounds);
  found.low = bounds.low;
  found.most = bounds.most;
  const DepthMasks<FloatLanes> of_hit =
      compare_depths(bounds, outer_near, outer_far, hn::Set(d, depths.inner_near), hn::Set(d, depths.inner_far));
  const LaneMask out = hn::Or(hn::Or(missed, outside), hn::And(hit, of_hit.outside));
  const uint32_t possible = triangles.used & ~mask_bits(out), certain = possible & mask_bits(hit);
  return {possible, certain, certain & mask_bits(of_hit.inside)};
}

HWY_INLINE LeafMasks test_triangles(const TriangleLanes& ray, const LeafTriangles& triangles,
                                    const DepthLimits& depths) {
  LeafDepths found;
  return test_triangles(ray, triangles, depths, found);
}

/// See scalar::test_triangles().
HWY_INLINE LeafMasks test_triangles(const TriangleLanes& ray, const TriangleLeaf& leaf, const DepthLimits& depths,
                                    LeafDepths& found) {
  return test_triangles(ray, load_triangles(leaf, ray.axis), depths, found);
}

HWY_INLINE LeafMasks test_triangles(const TriangleLanes& ray, const TriangleLeaf& leaf, const DepthLimits& depths) {
  return test_triangles(ray, load_triangles(leaf, ray.axis), depths);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
