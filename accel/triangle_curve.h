#pragma once

// Triangles in the order of a Morton curve, without a copy of them: a key of 8 bytes a triangle is all that is kept.

#include <rayloom/accel/morton.h>
#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/accel/triangle_numbers.h>

namespace rayloom::accel {

/// Active triangles (triangle_refs in triangle_input.h) by place on the curve; keys' indices are triangle numbers.
/// Where more than a leaf's worth of keys agree they are told apart by 63 bits.
class TriangleCurve {
 public:
  /// Throws InputError for an index out of range.
  TriangleCurve(std::span<const TriangleGeometry> geometries, bool keep_degenerate);

  /// Some triangles whose keys on a curve are known.
  TriangleCurve(std::span<const TriangleGeometry> geometries, const MortonCurve& curve, std::span<const MortonKey> keys)
      : numbers_(geometries), keep_degenerate_(false), curve_(curve), keys_(keys.begin(), keys.end()) {}

  const TriangleNumbers& numbers() const { return numbers_; }
  const MortonCurve& curve() const { return curve_; }
  std::span<const MortonKey> keys() const { return keys_; }
  /// All 63 bits of a triangle's code.
  uint64_t code(uint32_t number) const;

  /// References to the triangles of some keys, in their order; and rows of them, if asked for and true is returned.
  bool gather(std::span<const MortonKey> keys, PrimitiveRef* refs, const TriangleRows* rows = nullptr) const;

 private:
  Box frame() const;
  Box make_keys_on(const MortonCurve& curve);
  void prefetch_indices(uint32_t number) const;
  void prefetch_vertices(uint32_t number) const;

  TriangleNumbers numbers_;
  bool keep_degenerate_;
  MortonCurve curve_;
  ScratchVector<MortonKey> keys_;
};

}  // namespace rayloom::accel
