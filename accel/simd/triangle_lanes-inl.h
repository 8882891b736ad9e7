// Eight triangles read at once, re-included once per target by Highway's foreach_target.h. For geometries that
// vectors_read() accepts; what is computed has the bits of triangle_numbers.h.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_TRIANGLE_LANES_INL_H_
#undef RAYLOOM_ACCEL_TRIANGLE_LANES_INL_H_
#else
#define RAYLOOM_ACCEL_TRIANGLE_LANES_INL_H_
#endif
// clang-format on

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/read_ahead.h>
#include <rayloom/accel/simd/lanes-inl.h>

#include <algorithm>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

inline constexpr uint32_t triangle_lanes = 8;

/// As read_ahead, for reads of 96 bytes at a time.
HWY_INLINE void read_ahead_96(const void* now) {
  constexpr size_t line = 64;
  read_ahead(now);
  read_ahead(static_cast<const std::byte*>(now) + line);
}

struct IndexLanes {
  WordLanes vertex[3];
};

struct PointLanes {
  FloatLanes axis[3];
};

struct CornerLanes {
  PointLanes corner[3];
};

struct ExtentLanes {
  PointLanes min, max;
};

/// The caller's buffers.
class TriangleReader {
 public:
  HWY_INLINE explicit TriangleReader(const TriangleGeometry& geometry)
      : vertices_(reinterpret_cast<const float*>(geometry.vertices)),
        indices_(reinterpret_cast<const uint32_t*>(geometry.indices)),
        stride_(hn::Set(Words(), static_cast<uint32_t>(geometry.vertex_stride))),
        vertex_count_(hn::Set(Words(), geometry.vertex_count)) {}

  /// Of `count` triangles from `first` on; lanes beyond repeat the first. To be called from front to back.
  HWY_INLINE IndexLanes sequence(uint32_t first, uint32_t count) const {
    const Words d;
    IndexLanes result;
    const uint32_t* from = indices_ + 3 * size_t{first};
    read_ahead_96(from);
    uint32_t few[3 * triangle_lanes];
    if (count < triangle_lanes) {
      for (uint32_t lane = 0; lane < triangle_lanes; ++lane)
        std::memcpy(few + 3 * lane, from + (lane < count ? 3 * lane : 0), 3 * sizeof(uint32_t));
      from = few;
    }
    hn::LoadInterleaved3(d, from, result.vertex[0], result.vertex[1], result.vertex[2]);
    return result;
  }

  HWY_INLINE IndexLanes indices(WordLanes triangle) const {
    const auto offset = hn::BitCast(Ints(), hn::Mul(triangle, hn::Set(Words(), 12)));
    IndexLanes result;
    for (int v = 0; v < 3; ++v) result.vertex[v] = hn::GatherOffset(Words(), indices_ + v, offset);
    return result;
  }

  HWY_INLINE bool in_range(const IndexLanes& indices) const {
    const WordLanes most = hn::Max(hn::Max(indices.vertex[0], indices.vertex[1]), indices.vertex[2]);
    return hn::AllTrue(Words(), hn::Lt(most, vertex_count_));
  }

  HWY_INLINE PointLanes vertex(WordLanes index) const {
    const auto offset = hn::BitCast(Ints(), hn::Mul(index, stride_));
    PointLanes point;
    for (int k = 0; k < 3; ++k) point.axis[k] = hn::GatherOffset(Floats(), vertices_ + k, offset);
    return point;
  }

  HWY_INLINE CornerLanes corners(const IndexLanes& indices) const {
    return {{vertex(indices.vertex[0]), vertex(indices.vertex[1]), vertex(indices.vertex[2])}};
  }

 private:
  const float* vertices_;
  const uint32_t* indices_;
  WordLanes stride_, vertex_count_;
};

/// As Corners4::box.
HWY_INLINE ExtentLanes box_of(const CornerLanes& triangle) {
  ExtentLanes box;
  const auto& c = triangle.corner;
  const auto zero = hn::Zero(Floats());
  for (int k = 0; k < 3; ++k) {
    box.min.axis[k] = hn::Add(hn::Min(hn::Min(c[0].axis[k], c[1].axis[k]), c[2].axis[k]), zero);
    box.max.axis[k] = hn::Add(hn::Max(hn::Max(c[0].axis[k], c[1].axis[k]), c[2].axis[k]), zero);
  }
  return box;
}

/// As centre4.
HWY_INLINE PointLanes centre_of(const ExtentLanes& box) {
  PointLanes centre;
  const auto half = hn::Set(Floats(), 0.5f);
  for (int k = 0; k < 3; ++k) centre.axis[k] = hn::Add(hn::Mul(half, box.min.axis[k]), hn::Mul(half, box.max.axis[k]));
  return centre;
}

HWY_INLINE LaneMask equal_points(const PointLanes& a, const PointLanes& b) {
  return hn::And(hn::And(hn::Eq(a.axis[0], b.axis[0]), hn::Eq(a.axis[1], b.axis[1])), hn::Eq(a.axis[2], b.axis[2]));
}

/// As is_kept.
HWY_INLINE LaneMask kept(const CornerLanes& triangle, bool keep_degenerate) {
  const auto& c = triangle.corner;
  FloatLanes none = hn::Zero(Floats());  // NaN where any coordinate is not finite
  for (const PointLanes& point : c)
    for (const FloatLanes& x : point.axis) none = hn::Add(none, hn::Sub(x, x));
  const LaneMask finite = hn::Eq(none, none);
  if (keep_degenerate) return finite;
  const LaneMask equal = hn::Or(hn::Or(equal_points(c[0], c[1]), equal_points(c[1], c[2])), equal_points(c[2], c[0]));
  return hn::AndNot(equal, finite);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // RAYLOOM_ACCEL_TRIANGLE_LANES_INL_H_
