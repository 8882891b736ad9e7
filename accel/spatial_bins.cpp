#include <rayloom/accel/spatial_bins.h>

namespace rayloom::accel {
namespace {

Float4 corner4(const float (&p)[3]) { return Float4{p[0], p[1], p[2], 0}; }

/// A triangle with its corners in order along one axis, met by planes across that axis in rising order.
class Slices {
 public:
  Slices(const InputTriangle& triangle, int axis) : axis_(axis) {
    int low = 0, middle = 1, high = 2;
    const auto at = [&](int corner) { return triangle.vertex[corner][axis]; };
    if (at(middle) < at(low)) std::swap(low, middle);
    if (at(high) < at(middle)) std::swap(middle, high);
    if (at(middle) < at(low)) std::swap(low, middle);
    low_ = corner4(triangle.vertex[low]);
    middle_ = corner4(triangle.vertex[middle]);
    high_ = corner4(triangle.vertex[high]);
  }

  /// Box of the part between two planes inside the triangle's extent.
  Box4 between(float from, float to) {
    Box4 box;
    add_section(from, box);
    add_section(to, box);
    if (from <= middle_[axis_] && middle_[axis_] <= to) box.extend(middle_, middle_);
    return box;
  }

 private:
  Float4 point(Float4 a, Float4 b, float plane) const {
    const float length = b[axis_] - a[axis_];
    const float at = length > 0 ? (plane - a[axis_]) / length : 0.0f;
    return a + at * (b - a);
  }
  void add_section(float plane, Box4& box) const {
    const Float4 p = point(low_, high_, plane);
    const Float4 q = plane < middle_[axis_] ? point(low_, middle_, plane) : point(middle_, high_, plane);
    box.extend(minimum(p, q), maximum(p, q));
  }

  int axis_;
  Float4 low_, middle_, high_;
};

void cut_to(const Box4& cell, Box4& box) {
  box.min = maximum(box.min, cell.min);
  box.max = minimum(box.max, cell.max);
}

}  // namespace

SpatialAxis::SpatialAxis(const Box& box, int axis) {
  constexpr double largest = 1e36;
  const double extent = box.extent(axis);
  if (!(extent > 0) || std::max(std::abs(box.min[axis]), std::abs(box.max[axis])) > largest) return;
  low = box.min[axis];
  width = static_cast<float>(extent / spatial_bins);
  scale = static_cast<float>(std::min(spatial_bins / extent, 1e36));
}

void SpatialBins::add(const PrimitiveRef& ref, const SpatialAxes& axes, const SplittableTriangles& triangles) {
  const Box4 cell = box4(ref);
  std::optional<InputTriangle> triangle;
  for (int axis = 0; axis < 3; ++axis) {
    const SpatialAxis& planes = axes[axis];
    int first = planes.bin(ref.min[axis]), last = planes.bin(ref.max[axis]);
    if (first != last && !triangles.can_split(ref)) first = last = planes.bin(ref.centre(axis));
    auto& row = bins[axis];
    ++row[first].enter;
    ++row[last].leave;
    if (first == last) {
      row[first].box.extend(cell);
      continue;
    }
    if (!triangle) triangle = triangles.read(ref);
    Slices slices(*triangle, axis);
    for (int bin = first; bin <= last; ++bin) {
      const float from = bin == first ? ref.min[axis] : planes.plane(bin);
      const float to = bin == last ? ref.max[axis] : planes.plane(bin + 1);
      Box4 part = slices.between(from, to);
      cut_to(cell, part);
      row[bin].box.extend(part);
    }
  }
}

void SpatialBins::merge(const SpatialBins& other) {
  for (int axis = 0; axis < 3; ++axis)
    for (int bin = 0; bin < spatial_bins; ++bin) bins[axis][bin].merge(other.bins[axis][bin]);
}

}  // namespace rayloom::accel
