#pragma once

// What a build puts into a TriangleLeaf.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/primitive_ref.h>

#include <span>

namespace rayloom::accel {

/// Up to eight triangles with their vertices, equal ones once.
struct LeafContents {
  uint32_t count = 0;
  uint32_t slots = 0;  ///< vertices, or TriangleLeaf::plain_slots
  bool mixed = false;
  float position[TriangleLeaf::plain_slots][3] = {};
  uint8_t corner[3][8] = {};
  uint32_t primitive[8] = {};
  uint32_t geometry[8] = {};

  uint64_t bytes() const { return TriangleLeaf::bytes(slots, mixed); }
  void write(std::byte* address) const;
};

enum class LeafForm : uint8_t {
  table,  ///< the smallest
  plain,  ///< every lane keeps its own vertices: the quickest to build
  full,   ///< and its own geometry: PlainTriangleLeaf, which can be updated
};

LeafContents leaf_contents(std::span<const TriangleGeometry> geometries, std::span<const PrimitiveRef> refs,
                           LeafForm form);

}  // namespace rayloom::accel
