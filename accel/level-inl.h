// What a ray carries through one level. Included once for each set of lane tests, as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_LEVEL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_LEVEL_INL_H
#undef RAYLOOM_ACCEL_LEVEL_INL_H
#else
#define RAYLOOM_ACCEL_LEVEL_INL_H
#endif
// clang-format on

#include <rayloom/accel/depth_interval.h>
#include <rayloom/accel/search.h>
#include <rayloom/accel/structure.h>

#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/simd/prepare-inl.h>
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#include <rayloom/accel/simd/lanes_scalar.h>
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

/// A structure as one ray sees it. Distances are in the box space of this level's prepared ray.
struct Level {
  Level() = default;
  /// pad_scale: see prepare_ray(). Nothing may be traced if ray.valid is false.
  Level(const std::byte* structure, const BoundsLanes& bounds, const Ray& unprepared, const Search& search) {
    start(structure, bounds, unprepared, search);
  }
  Level(const std::byte* structure, const Ray& unprepared, float pad_scale, const Search& search)
      : Level(structure, BoundsLanes(header_of(structure), pad_scale), unprepared, search) {}

  [[gnu::always_inline]] void start(const std::byte* structure, const BoundsLanes& bounds, const Ray& unprepared,
                                    const Search& search) {
    block = structure;
    prepare_lanes(unprepared, bounds, ray);
    if (!ray.valid) return;
    t_near = ray.near_limit(ray.t_min);
    t_far = ray.far_limit(search.t());
    depths = DepthInterval(ray, search.t());
  }
  [[gnu::always_inline]] void shorten(const Search& search) {
    t_far = ray.far_limit(search.t());
    depths.shorten(search.t());
  }
  const StructureHeader& header() const { return header_of(block); }
  const Node8& node(uint32_t ref) const { return *reinterpret_cast<const Node8*>(block + node_ref::offset(ref)); }

  PreparedRay ray;
  const std::byte* block;
  float t_near, t_far;
  DepthInterval depths;
};

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
