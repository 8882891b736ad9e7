#pragma once

// The bytes of a lazy structure: the top of a tree over parts of triangles, and what building the parts takes. It keeps
// copies of its inputs, and room for all that may be built, so that nothing but its own block is needed later:
//
//   header | state | roots of parts | parts | nodes above parts | room for what is built of parts | geometries | keys |
//   buffers
//
// Its header says that it has no root, as an empty structure's does, and lazy_root instead: kernels for ordinary
// structures take neither, so they have nothing to tell apart.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/morton.h>

#include <span>
#include <type_traits>

namespace rayloom::accel {

/// Most triangles of a part. Measured: rays come to fewer triangles in parts of 512 than in larger ones (in 77 % of
/// atrium's parts against 87 % of those of 1024), and with smaller ones a triangle costs more.
inline constexpr uint32_t lazy_part_size = 512;

/// Most parts that so many triangles are cut into: half-full ones are usual.
inline constexpr uint64_t most_lazy_parts(uint64_t primitives) { return 4 * primitives / lazy_part_size + 1; }

/// A part of the triangles, and the leaf that stands for it in the tree above: so many bytes of it as a filter reads
/// say that there are no triangles in it.
struct alignas(granule_bytes) LazyPart {
  uint32_t first, count;  ///< its keys
  uint32_t budget;        ///< leaves it may have
  uint32_t none[5];
};
static_assert(sizeof(LazyPart) == granule_bytes && offsetof(TriangleLeaf, count) >= offsetof(LazyPart, none));

/// What may stand for the root of a part that is not built.
inline constexpr uint32_t part_unbuilt = 0, part_being_built = 1;

/// The depth at which the tree above parts begins, and each part's own: choices end at max_choice_depth, and halving
/// takes at most 22 levels above parts and 7 in them, so that both together fit into max_depth.
inline constexpr uint32_t lazy_first_depth = 16;

/// Follows the header. Places are counted in bytes from the block's start.
struct alignas(32) LazyState {
  MortonCurve curve;
  uint64_t geometries, keys;
  uint32_t key_count;
  uint32_t built_count;   ///< parts; changes while rays are traced
  uint32_t next_granule;  ///< where the next part's bytes go; changes likewise
};
static_assert(std::is_trivially_copyable_v<LazyState>);

/// A geometry's copy: vertices as the build sees them, 12 bytes each.
struct LazyGeometry {
  uint64_t vertices, indices;  ///< places
  uint32_t vertex_count, triangle_count, flags;
  IndexFormat index_format;
};

/// Leaves that a part of so many triangles may have: half as many again as full ones (an eighth with minimize_memory).
uint64_t part_leaf_budget(uint64_t triangles, const BuildSettings& settings);

/// Where everything lies. Follows from counts and flags alone (PB-03).
struct LazyLayout {
  /// A word a part: part_unbuilt, part_being_built or a node_ref; they change while rays are traced.
  static constexpr uint64_t roots = sizeof(StructureHeader) + sizeof(LazyState);
  uint64_t parts, nodes, built, geometries, keys, buffers, bytes;
};
LazyLayout lazy_layout(std::span<const TriangleGeometry> geometries, const BuildSettings& settings);

/// Whether a geometry is copied without its indices, since it has many vertices that it does not use.
inline bool copies_unindexed(const TriangleGeometry& geometry) {
  return geometry.index_format == IndexFormat::none || geometry.vertex_count > 3 * uint64_t{geometry.triangle_count};
}

inline uint64_t copied_vertices(const TriangleGeometry& geometry) {
  return copies_unindexed(geometry) ? 3 * uint64_t{geometry.triangle_count} : geometry.vertex_count;
}

inline uint64_t copied_index_bytes(const TriangleGeometry& geometry) {
  if (copies_unindexed(geometry)) return 0;
  return uint64_t{geometry.triangle_count} * (geometry.index_format == IndexFormat::uint16 ? 6 : 12);
}

inline const LazyState& lazy_state(const std::byte* block) {
  return *reinterpret_cast<const LazyState*>(block + sizeof(StructureHeader));
}
inline LazyState& lazy_state(std::byte* block) {
  return *reinterpret_cast<LazyState*>(block + sizeof(StructureHeader));
}

}  // namespace rayloom::accel
