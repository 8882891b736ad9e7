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

#include <rayloom/accel/layout.h>
#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/simd/lane_masks.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::FixedTag<float, 8>;
using Words = hn::FixedTag<uint32_t, 8>;
using FloatLanes = hn::Vec<Floats>;
using WordLanes = hn::Vec<Words>;
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
  HWY_INLINE explicit TriangleLanes(const PreparedRay& ray) {
    const Floats d;
    for (int k = 0; k < 3; ++k) {
      origin[k] = hn::Set(d, ray.ordered_origin[k]);
      vertex_row[k] = size_t{ray.axis[k]} * 8;
    }
    for (int i = 0; i < 2; ++i) shear[i] = hn::Set(d, ray.shear[i]);
  }

  FloatLanes origin[3], shear[2];
  size_t vertex_row[3];
};

HWY_INLINE uint32_t mask_bits(LaneMask mask) {
  uint8_t bits = 0;
  hn::StoreMaskBits(Floats(), mask, &bits);
  return bits;
}

HWY_INLINE LaneMask used_lanes(const uint32_t* primitive) {
  return hn::RebindMask(Floats(), hn::Ne(hn::Load(Words(), primitive), hn::Set(Words(), no_index)));
}

/// Entry and exit of eight boxes, clipped to [t_near, t_far]; entry > exit: missed.
struct BoxIntervals {
  FloatLanes entry, exit;
};

HWY_INLINE BoxIntervals box_intervals(const BoxLanes& ray, const float* planes, float t_near, float t_far) {
  const Floats d;
  FloatLanes entry[3], exit[3];
  for (int k = 0; k < 3; ++k) {
    entry[k] = hn::MulAdd(hn::Load(d, planes + ray.near_row[k]), ray.reciprocal[k], ray.near_offset[k]);
    exit[k] = hn::MulAdd(hn::Load(d, planes + ray.far_row[k]), ray.reciprocal[k], ray.far_offset[k]);
  }
  return {hn::Max(hn::Max(entry[0], entry[1]), hn::Max(entry[2], hn::Set(d, t_near))),
          hn::Min(hn::Min(exit[0], exit[1]), hn::Min(exit[2], hn::Set(d, t_far)))};
}

/// See scalar::NodeHits. A key is a rounded entry distance, which is not negative, with the lane in its low bits.
struct NodeHits {
  uint32_t mask;
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
  return {mask_bits(hn::Le(intervals.entry, intervals.exit)), hn::Or(rounded, hn::Iota(w, 0))};
}

/// See scalar::test_boxes().
HWY_INLINE uint32_t test_boxes(const BoxLanes& ray, const ProceduralLeaf8& leaf, float t_near, float t_far) {
  const BoxIntervals intervals = box_intervals(ray, &leaf.bounds[0][0][0], t_near, t_far);
  return mask_bits(hn::And(hn::Le(intervals.entry, intervals.exit), used_lanes(leaf.primitive)));
}

/// One vertex of eight triangles in the ray's sheared frame.
struct ShearedVertex {
  FloatLanes x, y, z;
  HWY_INLINE FloatLanes extent() const { return hn::Add(hn::Abs(x), hn::Abs(y)); }
};

HWY_INLINE ShearedVertex shear_vertex(const TriangleLanes& ray, const float* rows) {
  const Floats d;
  const FloatLanes z = hn::Sub(hn::Load(d, rows + ray.vertex_row[2]), ray.origin[2]);
  const FloatLanes x = hn::Sub(hn::Load(d, rows + ray.vertex_row[0]), ray.origin[0]);
  const FloatLanes y = hn::Sub(hn::Load(d, rows + ray.vertex_row[1]), ray.origin[1]);
  return {hn::NegMulAdd(ray.shear[0], z, x), hn::NegMulAdd(ray.shear[1], z, y), z};
}

HWY_INLINE FloatLanes edge_function(const ShearedVertex& a, const ShearedVertex& b) {
  return hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x));
}

/// The bound of scalar::filter_triangle().
HWY_INLINE FloatLanes edge_bound(const ShearedVertex& a, const ShearedVertex& b, const ShearedVertex& c) {
  const Floats d;
  const FloatLanes extent = hn::Add(hn::Add(a.extent(), b.extent()), c.extent());
  const FloatLanes depth = hn::Max(hn::Max(hn::Abs(a.z), hn::Abs(b.z)), hn::Abs(c.z));
  const FloatLanes wide = hn::MulAdd(hn::Set(d, 0x1p-21f), depth, extent);
  const FloatLanes slope = hn::MulAdd(hn::Set(d, 1.625f), extent, hn::Mul(hn::Set(d, 3.125f), depth));
  return hn::MulAdd(hn::Mul(wide, slope), hn::Set(d, 0x1p-24f), hn::Set(d, 0x1p-126f));
}

/// See scalar::test_triangles().
HWY_INLINE LeafMasks test_triangles(const TriangleLanes& ray, const TriangleLeaf8& leaf) {
  const ShearedVertex a = shear_vertex(ray, &leaf.vertex[0][0][0]);
  const ShearedVertex b = shear_vertex(ray, &leaf.vertex[1][0][0]);
  const ShearedVertex c = shear_vertex(ray, &leaf.vertex[2][0][0]);
  const FloatLanes ab = edge_function(a, b), bc = edge_function(b, c), ca = edge_function(c, a);
  const FloatLanes bound = edge_bound(a, b, c);
  const FloatLanes below = hn::Neg(bound);

  // An edge function is NaN only if the bound is infinite or NaN, when no comparison holds; so the extremes may be
  // taken first.
  const FloatLanes low = hn::Min(hn::Min(ab, bc), ca), high = hn::Max(hn::Max(ab, bc), ca);
  const LaneMask missed = hn::And(hn::Gt(high, bound), hn::Lt(low, below));
  const LaneMask hit = hn::Or(hn::Gt(low, bound), hn::Lt(high, below));
  const LaneMask used = hn::Eq(a.z, a.z);
  return {mask_bits(hn::AndNot(missed, used)), mask_bits(hn::And(hit, used))};
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // include guard
