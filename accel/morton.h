#pragma once

// Morton codes of 63 bits: 21 bits an axis, interleaved, so that codes in order are places along a space-filling curve
// (Lauterbach et al., "Fast BVH Construction on GPUs", 2009). 30 bits would not tell apart a dense object in a large
// scene.

#include <rayloom/accel/primitive_ref.h>

#include <cstdint>
#include <span>

namespace rayloom::accel {

/// A primitive's place on the curve to 32 bits and its index among the references. All that is sorted for most keys.
struct MortonKey {
  uint32_t code;
  uint32_t index;
};

/// The code of grid cell (x, y, z), coordinates below 2^21; x has the highest bit.
uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z);

/// A curve over a cubic grid of 2^21 cells an axis that spans all centres. In double every float centre falls into the
/// cell it lies in, to 2^-31 of a cell.
class MortonCurve {
 public:
  explicit MortonCurve(const Box& centres);
  uint64_t code(const PrimitiveRef& ref) const;
  /// The upper 32 of the 63 bits.
  uint32_t upper_code(const PrimitiveRef& ref) const;

 private:
  uint32_t cell(const PrimitiveRef& ref, int axis) const {
    return static_cast<uint32_t>(static_cast<int32_t>((double{ref.centre(axis)} - low_[axis]) * scale_));
  }
  double low_[3], scale_;
};

/// Keys of all `refs`, sorted by 63-bit code; equal codes by name of the reference. Any order in, the same references
/// out.
ScratchVector<MortonKey> sorted_keys(const MortonCurve& curve, std::span<const PrimitiveRef> refs);

}  // namespace rayloom::accel
