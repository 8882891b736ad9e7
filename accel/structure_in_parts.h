#pragma once

// Structures of triangles straight into their bytes. Triangles are sorted along a Morton curve and cut into parts of
// some thousands; a part's references, tree and leaves live in the cache, and only its finished bytes leave it. The top
// of the tree is then built over the parts' uppermost subtrees by surface area: as in HLBVH (Garanzha, Pantaleoni,
// McAllister 2011), but with any builder for the parts.

#include <rayloom/accel/tree_builder.h>

#include <cstddef>

namespace rayloom::accel {

class TriangleCurve;

/// Whether triangles are built in parts. Not where they are split, nor where moving any subtree to any place is what a
/// build takes its time for.
inline constexpr bool builds_in_parts(Builder builder) {
  return builder != Builder::spatial_splits && builder != Builder::reinsertion;
}

/// Writes all of a structure but its header, which must name kind and counts and gets the rest; input.triangles are
/// what is built. Throws InputError for an index out of range.
void build_in_parts(const TreeInput& input, StructureHeader& header, std::span<std::byte> block);
/// The same for triangles in their order, at least one.
void build_in_parts(const TriangleCurve& order, const TreeInput& input, StructureHeader& header,
                    std::span<std::byte> block);

}  // namespace rayloom::accel
