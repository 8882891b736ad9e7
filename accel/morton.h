#pragma once

// Morton codes of 63 bits: 21 bits an axis, interleaved, so that codes in order are places along a space-filling curve
// (Lauterbach et al., "Fast BVH Construction on GPUs", 2009). 30 bits would not tell apart a dense object in a large
// scene.

#include <rayloom/accel/primitive_ref.h>

#include <cstdint>
#include <span>

namespace rayloom::accel {

/// A primitive's place on the curve and its index among the references.
struct MortonKey {
  uint64_t code;
  uint32_t index;
};

/// The code of grid cell (x, y, z), coordinates below 2^21; x has the highest bit.
uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z);

/// Codes of the centres of `refs`, in their order, on a cubic grid over all centres.
ScratchVector<MortonKey> morton_keys(std::span<const PrimitiveRef> refs);

/// Sorts by code; equal codes by name of the reference. Any order in, the same references out.
void sort_keys(ScratchVector<MortonKey>& keys, std::span<const PrimitiveRef> refs);

}  // namespace rayloom::accel
