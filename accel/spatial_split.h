#pragma once

// Splits of space instead of objects: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies"
// (2009). A triangle on both sides of the plane becomes two references with smaller boxes.

#include <rayloom/accel/clip_triangle.h>
#include <rayloom/accel/primitive_ref.h>

#include <optional>
#include <span>

namespace rayloom::accel {

/// The plane, and what binning expects of the two sides. A reference is on the left if its box ends at the plane, on
/// the right if it begins there.
struct SpatialSplit {
  int axis = 0;
  float plane = 0;
  Box left, right;
  uint64_t left_count = 0, right_count = 0;
  double cost = 0;  ///< as Split's
};

/// Triangles that references name. Those of geometries that are not opaque stay whole: the candidate function is asked
/// once for a triangle and ray.
class SplittableTriangles {
 public:
  explicit SplittableTriangles(std::span<const TriangleGeometry> geometries) : geometries_(geometries) {}
  bool can_split(const PrimitiveRef& ref) const { return geometries_[ref.geometry].flags & geometry_flag::opaque; }
  InputTriangle read(const PrimitiveRef& ref) const { return read_triangle(geometries_[ref.geometry], ref.primitive); }

 private:
  std::span<const TriangleGeometry> geometries_;
};

/// What a split may spend.
struct SplitLimits {
  uint32_t leaf_size;
  uint64_t blocks;      ///< leaves of both sides together
  uint64_t references;  ///< of both sides together
};

/// The cheapest plane between bins of equal width over `box`, which encloses `refs`, that leaves each side fewer
/// references than there were.
std::optional<SpatialSplit> find_spatial_split(std::span<const PrimitiveRef> refs, const Box& box,
                                               const SplittableTriangles& triangles, const SplitLimits& limits);

/// How many references lie to the left and right of a plane.
struct SpatialParts {
  size_t left = 0, right = 0;
};

/// Writes those on the left and then those on the right to `parts`, each in the order of `refs`; a triangle on both
/// sides is written twice, or whole to one side where that costs less ("reference unsplitting"). Nothing is written or
/// returned if `parts` has too little room.
std::optional<SpatialParts> partition_by_plane(std::span<const PrimitiveRef> refs, const SpatialSplit& split,
                                               const SplittableTriangles& triangles, std::span<PrimitiveRef> parts);

}  // namespace rayloom::accel
