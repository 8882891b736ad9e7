#pragma once

// Counting and enclosing what lies between planes of equal distance, the triangles cut at the planes. The boxes only
// guide the choice of a plane: they are computed in plain float.

#include <rayloom/accel/float4.h>
#include <rayloom/accel/spatial_split.h>

#include <array>

namespace rayloom::accel {

inline constexpr int spatial_bins = 16;

/// Planes over one axis of a box. Flat axes, and boxes too large for float differences, have one bin.
struct SpatialAxis {
  float low = 0, width = 0, scale = 0;
  SpatialAxis() = default;
  SpatialAxis(const Box& box, int axis);
  int bin(float x) const { return std::clamp(static_cast<int>((x - low) * scale), 0, spatial_bins - 1); }
  /// Lower plane of a bin.
  float plane(int bin) const { return low + static_cast<float>(bin) * width; }
};

struct SpatialBin {
  Box4 box;
  uint32_t enter = 0, leave = 0;  ///< references whose first and last bin this is
  void merge(const SpatialBin& other) {
    box.extend(other.box);
    enter += other.enter;
    leave += other.leave;
  }
};

using SpatialAxes = std::array<SpatialAxis, 3>;

struct SpatialBins {
  std::array<std::array<SpatialBin, spatial_bins>, 3> bins;
  void add(const PrimitiveRef& ref, const SpatialAxes& axes, const SplittableTriangles& triangles);
  void merge(const SpatialBins& other);
};

}  // namespace rayloom::accel
