#pragma once

// Binned surface area heuristic: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies" (2007), with
// cost counted in leaf blocks, since a leaf of one triangle costs as much to test as a leaf of eight.

#include <rayloom/accel/primitive_ref.h>

#include <bit>
#include <optional>
#include <span>

namespace rayloom::accel {

/// Leaves that primitives take at least; the leaf size is a power of two.
inline uint64_t blocks_for(uint64_t primitives, uint32_t leaf_size) {
  return (primitives + leaf_size - 1) >> std::countr_zero(leaf_size);
}

/// Boxes of a range of primitives and of their centres.
struct RangeBounds {
  Box box, centres;
};
RangeBounds bounds_of(std::span<const PrimitiveRef> refs);

/// Bins of equal width over one axis of the centres' box, in halves of coordinates, which do not overflow when
/// subtracted. A flat axis maps everything to bin 0.
struct BinAxis {
  float low = 0, scale = 0;
  int bin(const PrimitiveRef& ref, int axis) const {
    return static_cast<int>(((0.25f * ref.min[axis] + 0.25f * ref.max[axis]) - low) * scale);
  }
};

/// "Bin of the centre on `axis` below `bin`" goes left.
struct Split {
  int axis = 0;
  int bin = 0;
  BinAxis bins;
  double cost = 0;  ///< half areas of the parts times their leaf blocks, summed
  bool goes_left(const PrimitiveRef& ref) const { return bins.bin(ref, axis) < bin; }
};

/// The cheapest split of `refs` into parts that fit `block_budget` leaf blocks together, if any candidate does.
/// `leaf_size` is a power of two.
std::optional<Split> find_binned_split(std::span<const PrimitiveRef> refs, const Box& centres, uint32_t leaf_size,
                                       uint64_t block_budget);

}  // namespace rayloom::accel
