#pragma once

// What builders do to many triangles at once, in vectors. Results have the bits that the scalar code gives.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/collapse_plan.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/morton.h>

namespace rayloom::accel {

/// Triangles [begin, end) of a geometry that vectors can read, and how their places on a curve follow.
struct KeyRange {
  const TriangleGeometry* geometry;
  uint32_t begin, end;
  uint32_t first_number;  ///< of the geometry's triangles
  bool keep_degenerate;
  const MortonCurve* curve;
};

/// The triangles of a geometry that vectors can read.
struct RefRange {
  const TriangleGeometry* geometry;
  uint32_t index;         ///< of the geometry
  uint32_t first_number;  ///< of its triangles
};

/// Primitives and indices of triangles one after another, row by row; eight more of each may be read and written.
struct TriangleRows {
  uint32_t *primitive, *vertex[3];
};

struct BuildKernel {
  /// Writes the keys of active triangles to `out` and returns their end; null for an index out of range. Extends
  /// `centres` by their centres.
  MortonKey* (*make_keys)(const KeyRange&, MortonKey* out, Box& centres);
  /// The box of all finite ones of `count` vertices of three floats each.
  Box (*vertex_bounds)(const std::byte* vertices, size_t count);
  /// References to the triangles, all of this geometry, that keys name; and rows of them, if asked for.
  void (*gather_refs)(const RefRange&, std::span<const MortonKey>, PrimitiveRef* refs, const TriangleRows* rows);
  /// Writes the leaf of 1 to 8 triangles of one geometry, all but its geometry word, and returns how many entries its
  /// table has; more than table_slots: nothing was written. `leaf` has room for a PlainTriangleLeaf.
  uint32_t (*write_table_leaf)(const TriangleGeometry&, std::span<const PrimitiveRef>, TriangleLeaf& leaf);
  /// The same of `count` triangles from `first` on, which it sorts.
  uint32_t (*write_leaf_of_rows)(const TriangleGeometry&, const TriangleRows&, size_t first, size_t count,
                                 TriangleLeaf& leaf);
  /// Plans for the subtree `slot` of a tree and all below it; areas are scaled.
  void (*plan_collapse)(const BinaryNode* tree, uint32_t slot, double area_scale, CollapsePlan* plans);
};

/// Of the instruction set in use; null where that has no vectors.
const BuildKernel* build_kernel();

/// Whether vectors can read a geometry: offsets fit a signed 32-bit lane, and nothing has to be moved.
inline bool vectors_read(const TriangleGeometry& geometry) {
  const uint64_t stride = static_cast<uint32_t>(geometry.vertex_stride);
  return !geometry.transform && geometry.index_format == IndexFormat::uint32 &&
         stride * geometry.vertex_count <= 0x7FFFFFFF && geometry.triangle_count <= 0x7FFFFFFF / 12;
}

}  // namespace rayloom::accel
