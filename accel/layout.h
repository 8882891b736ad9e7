#pragma once

// The bytes of a structure. Everything refers to everything else by a 32-bit reference that counts 32-byte granules
// from the block's start, so a block can be moved; 31 bits of granules reach 64 GiB. The hardware model walks these
// same bytes at their simulated addresses.

#include <cstddef>
#include <cstdint>

namespace rayloom::accel {

inline constexpr uint32_t granule_bytes = 32;

/// Child reference: granule index, top bit set for a leaf. An empty slot has an inverted box and is never followed.
namespace node_ref {
inline constexpr uint32_t leaf_bit = 0x80000000u;
inline constexpr bool is_leaf(uint32_t ref) { return (ref & leaf_bit) != 0; }
inline constexpr uint64_t offset(uint32_t ref) { return uint64_t{ref & ~leaf_bit} * granule_bytes; }
}  // namespace node_ref

/// Eight children. bounds[axis][side][child], side 0 the minimum: a ray picks the near plane by its direction's sign.
/// Empty slots: minimum +inf, maximum -inf.
struct alignas(32) Node8 {
  float bounds[3][2][8];
  uint32_t child[8];
};
static_assert(sizeof(Node8) == 224);

inline constexpr uint32_t leaf_lanes = 8;

/// Up to eight triangles over a table of their vertices, in 96 to 384 bytes: triangles side by side share vertices, and
/// where memory is slow a leaf costs as many lines as it takes. The table follows as coordinate[axis][slots]; after it,
/// if geometries are mixed, geometry[8].
struct alignas(32) TriangleLeaf {
  uint8_t corner[3][8];  ///< by vertex and lane, which entry of the table
  uint32_t geometry;     ///< 24-bit index, geometry_flag bits from bit 24; of every lane unless mixed
  uint8_t count;         ///< lanes in use, the lowest ones
  uint8_t slots;         ///< entries of the table; plain_slots: entry 8 * vertex + lane is that lane's own
  uint8_t mixed;         ///< 1: every lane has its own geometry
  uint8_t reserved;
  uint32_t primitive[8];

  /// Longest table that vectors look up (two registers); leaves of more vertices are plain.
  static constexpr uint32_t table_slots = 16, plain_slots = 24;
  /// The vector code loads tables in two vectors, whatever their length: so far may it read beyond a leaf.
  static constexpr uint64_t overread_bytes = 64;
  static constexpr uint64_t bytes(uint32_t slots, bool mixed) {
    const uint64_t used = 64 + 12 * uint64_t{slots} + (mixed ? 32 : 0);
    return (used + granule_bytes - 1) / granule_bytes * granule_bytes;
  }

  uint64_t bytes() const { return bytes(slots, mixed != 0); }
  uint32_t used_mask() const { return (1u << count) - 1; }
  const float* row(uint32_t axis) const { return reinterpret_cast<const float*>(this + 1) + axis * slots; }
  float* row(uint32_t axis) { return reinterpret_cast<float*>(this + 1) + axis * slots; }
  float coordinate(uint32_t vertex, uint32_t axis, uint32_t lane) const { return row(axis)[corner[vertex][lane]]; }
  uint32_t geometry_of(uint32_t lane) const {
    return mixed ? reinterpret_cast<const uint32_t*>(row(3))[lane] : geometry;
  }
};
static_assert(sizeof(TriangleLeaf) == 64);

/// The leaf that holds any eight triangles.
struct PlainTriangleLeaf : TriangleLeaf {
  float vertex[3][3][8];  ///< [axis][vertex][lane]
  uint32_t lane_geometry[8];
};
static_assert(sizeof(PlainTriangleLeaf) == TriangleLeaf::bytes(TriangleLeaf::plain_slots, true));

/// Up to eight procedural boxes, bounds[axis][side][lane]. Unused lanes: inverted boxes and primitive == no_index.
struct alignas(32) ProceduralLeaf8 {
  float bounds[3][2][8];
  uint32_t primitive[8];
  uint32_t geometry[8];
};
static_assert(sizeof(ProceduralLeaf8) == 256);

/// A leaf of a top-level structure: one instance or, re-braided (rebraid.h), the part of it below one node; its inverse
/// kept in double (numerics.md 3.5).
struct alignas(32) InstanceRecord {
  double world_to_object[3][4];
  float object_to_world[3][4];  ///< as given
  uint64_t bottom_level_address;
  uint32_t instance_index;          ///< position in the build's array (SV-27)
  uint32_t id_and_mask;             ///< 24-bit InstanceID, mask in the top 8 bits
  uint32_t contribution_and_flags;  ///< 24-bit contribution to the hit group index, instance_flag bits in the top 8
  uint32_t entry;                   ///< node_ref in the bottom level where rays start; 0: its root
};
static_assert(sizeof(InstanceRecord) == 192);

enum class StructureKind : uint32_t { triangles = 1, procedurals = 2, instances = 3 };

inline constexpr uint64_t structure_magic = 0x31304d4f4f4c5952;  // "RYLOOM01", little endian

/// First bytes of every block.
struct alignas(32) StructureHeader {
  uint64_t magic;
  StructureKind kind;
  uint32_t build_flags;
  uint64_t bytes;
  uint32_t root;   ///< node_ref; no_index for a structure without active primitives and for a lazy one
  uint32_t depth;  ///< nodes on the longest path; at most max_depth
  float bounds_min[3], bounds_max[3];
  uint32_t node_count, leaf_count;
  uint64_t primitive_count, active_count;
  uint32_t geometry_count;
  uint32_t non_opaque_count;  ///< geometries without the opaque flag, instances with force_non_opaque for a top level
  double sah_cost;
  float pad_scale;     ///< top level: 1 + the largest conditioning among its instances (docs/numerics.md); else 1
  uint32_t builder;    ///< enum Builder: what made the tree
  uint32_t lazy_root;  ///< of a lazy structure (lazy_layout.h) and of a top level over such; else 0
  uint32_t first_part, part_count;  ///< of a lazy bottom level: granules from the first on stand for parts; else 0
  uint32_t reserved[3];
};
static_assert(sizeof(StructureHeader) == 128 && offsetof(StructureHeader, bounds_min) == 32);

/// No builder makes a deeper tree: binary splits stop being chosen by cost at depth 32 and halve from there, and a
/// structure has at most 2^29 primitives (CAP-09). A stack of 7 * max_depth + 1 entries therefore never overflows.
inline constexpr uint32_t max_depth = 64;
inline constexpr uint32_t stack_entries = 7 * max_depth + 1;

}  // namespace rayloom::accel
