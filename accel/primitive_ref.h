#pragma once

#include <rayloom/accel/box.h>
#include <rayloom/accel/scratch_vector.h>

#include <cstdint>
#include <tuple>

namespace rayloom::accel {

/// What tree builders see of a primitive: its box and its name. Instances have the node
/// where they are entered for a geometry, 0 for the root.
/// Coordinates are finite and never -0, so that unions have the same bits in any order.
struct PrimitiveRef {
  float min[3];
  uint32_t geometry;
  float max[3];
  uint32_t primitive;

  /// Centre of the box; halving first keeps it finite.
  float centre(int axis) const { return 0.5f * min[axis] + 0.5f * max[axis]; }
};
static_assert(sizeof(PrimitiveRef) == 32);
using PrimitiveRefs = ScratchVector<PrimitiveRef>;

inline PrimitiveRef make_primitive_ref(const Box& box, uint32_t geometry, uint32_t primitive) {
  PrimitiveRef ref;
  for (int k = 0; k < 3; ++k) {
    ref.min[k] = box.min[k] + 0.0f;  // turns -0 into +0
    ref.max[k] = box.max[k] + 0.0f;
  }
  ref.geometry = geometry;
  ref.primitive = primitive;
  return ref;
}

/// The builders' only total order: by name.
inline bool name_less(const PrimitiveRef& a, const PrimitiveRef& b) {
  return std::tie(a.geometry, a.primitive) < std::tie(b.geometry, b.primitive);
}

}  // namespace rayloom::accel
