#pragma once

// An instance's map between world and object space, in double (docs/numerics.md, "Instances").

#include <rayloom/accel/box.h>
#include <rayloom/accel/build_input.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/ray.h>

#include <limits>
#include <optional>

namespace rayloom::accel {

struct InverseTransform {
  double matrix[3][4];
  double conditioning;  ///< |M| |M^-1| in the maximum norm, at least 1
};

/// Adjugate over determinant: exact for permutations, mirrors and powers of two. Empty when the matrix has a NaN, an
/// infinity, or no finite inverse (TL-08).
std::optional<InverseTransform> invert(const float (&object_to_world)[3][4]);

/// What a row of a transform makes of points: empty, low above high, of none.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};
/// Of a box that is not empty, as computed: right to 2^-50 of the largest of the row's products.
Interval image(const float (&row)[4], const Box& object_box);

/// The world-space box of an object-space box, rounded outward and widened for what rounding the object-space ray can
/// shift near the box itself; what grows with the ray's way is the traversal's pad (StructureHeader::pad_scale).
Box world_box(const float (&object_to_world)[3][4], const Box& object_box);
/// The same of points in the box whose image on each axis is known to lie closer.
Box widened_box(const float (&object_to_world)[3][4], const Box& object_box, const Interval (&images)[3]);

/// The ray in the instance's object space: computed in double, rounded once; t keeps its meaning (EXT-07).
Ray object_ray(const InstanceRecord& instance, const Ray& world_ray);

}  // namespace rayloom::accel
