#pragma once

// What a build puts into a TriangleLeaf.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/primitive_ref.h>
#include <rayloom/accel/simd/build_kernel.h>

#include <span>

namespace rayloom::accel {

enum class LeafForm : uint8_t {
  table,        ///< the smallest: equal vertices once, unless there are too many
  index_table,  ///< the same with vertices of one index, which is quicker; clipped leaves have no such form
  full,         ///< every lane keeps its own vertices and geometry: PlainTriangleLeaf, which can be updated
};

struct TriangleLeafWriter {
  std::span<const TriangleGeometry> geometries;
  LeafForm form = LeafForm::table;
  bool clipped = false;  ///< references may be smaller than their triangles

  /// Writes the leaf of up to eight triangles and returns its bytes. `address` has room for a PlainTriangleLeaf, of
  /// which bytes beyond the leaf are left undefined.
  uint64_t write(std::span<const PrimitiveRef> refs, std::byte* address) const;

  /// The same without looking at indices: equal vertices are those of equal bits, unless the form is `full`.
  uint64_t write_by_value(std::span<const PrimitiveRef> refs, std::byte* address) const;

  /// The same of a range of rows that belongs to `refs`, sorted by primitive; only for geometry 0 as index_table.
  uint64_t write_of_rows(const TriangleRows& rows, size_t first, std::span<PrimitiveRef> refs,
                         std::byte* address) const;

  /// Asks for what write() will read: first the indices; later, when they have arrived, the vertices.
  void prefetch_indices(std::span<const PrimitiveRef> refs) const;
  void prefetch_vertices(std::span<const PrimitiveRef> refs) const;
};

}  // namespace rayloom::accel
