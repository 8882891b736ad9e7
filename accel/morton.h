#pragma once

// Morton codes of 63 bits: 21 bits an axis, interleaved, so that codes in order are places along a space-filling curve
// (Lauterbach et al., "Fast BVH Construction on GPUs", 2009). 30 bits would not tell apart a dense object in a large
// scene.

#include <rayloom/accel/float4.h>
#include <rayloom/accel/primitive_ref.h>

#include <cstdint>
#include <functional>
#include <span>

namespace rayloom::accel {

/// A primitive's place on the curve to 32 bits and its index among the primitives. All that is sorted for most keys.
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
  uint64_t code(Float4 centre) const;
  uint64_t code(const PrimitiveRef& ref) const { return code(centre4(box4(ref))); }
  /// The upper 32 of the 63 bits: 11 of x, 11 of y and 10 of z.
  uint32_t upper_code(Float4 centre) const {
    const Double4 place = (__builtin_convertvector(centre, Double4) - low_) * upper_scale_;
    const Word4 bits = spread11(__builtin_convertvector(__builtin_convertvector(place, Int4), Word4));
    return bits[0] << 1 | bits[1] | bits[2] << 2;
  }
  uint32_t upper_code(const PrimitiveRef& ref) const { return upper_code(centre4(box4(ref))); }
  /// Along one axis, the least centre and upper cells per unit.
  double low(int axis) const { return low_[axis]; }
  double upper_scale(int axis) const { return upper_scale_[axis]; }
  /// The longest side of the box that the curve spans.
  double extent() const { return extent_; }

 private:
  using Double4 __attribute__((vector_size(32))) = double;
  using Int4 __attribute__((vector_size(16))) = int32_t;
  using Word4 __attribute__((vector_size(16))) = uint32_t;

  /// Two zero bits after each of the low 11 bits of x.
  static Word4 spread11(Word4 x) {
    x = (x | x << 16) & 0x070000FFu;
    x = (x | x << 8) & 0x0700F00Fu;
    x = (x | x << 4) & 0x430C30C3u;
    return (x | x << 2) & 0x49249249u;
  }
  uint32_t cell(Float4 centre, int axis) const {
    return static_cast<uint32_t>(static_cast<int32_t>((double{centre[axis]} - low_[axis]) * scale_));
  }

  Double4 low_, upper_scale_;  ///< lane 3 is 0
  double scale_, extent_;
};

/// What a key's 32 bits leave open, by the key's index.
struct KeyDetails {
  std::function<uint64_t(uint32_t)> code;  ///< all 63 bits
  std::function<uint64_t(uint32_t)> name;  ///< decides where codes are equal
};

/// Sorts keys by code, in parallel. Runs of one code longer than `longest_run` are then sorted by 63-bit code and name;
/// shorter ones keep the order that keys came in.
void sort_keys(ScratchVector<MortonKey>& keys, size_t longest_run, const KeyDetails& details);

/// Keys of all `refs`, sorted by 63-bit code; equal codes by name of the reference. Any order in, the same references
/// out.
ScratchVector<MortonKey> sorted_keys(const MortonCurve& curve, std::span<const PrimitiveRef> refs);

}  // namespace rayloom::accel
