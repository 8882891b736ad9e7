#pragma once

// How large a structure can get, from counts and flags alone (PB-02 to PB-04). The builder keeps to these bounds: its
// splits never spend more leaves than leaf_budget(), and a wide tree of that many leaves has at most node_bound()
// nodes.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/layout.h>

#include <algorithm>

namespace rayloom::accel {

/// Rows of CAP-09.
inline constexpr uint64_t max_geometries = uint64_t{1} << 24;
inline constexpr uint64_t max_primitives = uint64_t{1} << 29;
inline constexpr uint64_t max_instances = uint64_t{1} << 24;

/// Primitives a bottom-level leaf holds (TriangleLeaf, ProceduralLeaf8).
inline constexpr uint32_t leaf_width = leaf_lanes;

/// Primitives and most bytes of a leaf in this kind of structure.
uint32_t leaf_size(StructureKind kind);
uint64_t leaf_bytes(StructureKind kind);

/// References that spatial splits may make of `primitives`.
inline constexpr uint64_t split_reference_bound(uint64_t primitives) { return primitives + primitives / 2; }

/// Whether a top level with these settings may hold several leaves an instance. Not where an update may give an
/// instance another bottom level, whose nodes lie elsewhere.
inline constexpr bool may_rebraid(const BuildSettings& settings) {
  return settings.rebraid && !(settings.flags & build_flag::allow_update);
}

/// Leaves that re-braiding may make of `instances`: few large ones that overlap gain most.
inline constexpr uint64_t rebraid_bound(uint64_t instances) { return std::min(16 * instances, 4 * instances + 4096); }

/// Leaves a tree over `primitives` may have: half as many again as full leaves would take (an eighth with
/// minimize_memory), and a few more so that small structures may split as they like.
uint64_t leaf_budget(uint64_t primitives, StructureKind kind, const BuildSettings& settings);

/// Most inner nodes a wide tree of `leaves` leaves can have. Collapse leaves no inner child with c children under a
/// parent with k when k - 1 + c <= 8, so k + c >= 10 across every edge. Put each node with at most 4 children (its
/// parent has at least 6) into its parent's group: a group of one node with k >= 5 and m <= k such nodes makes
/// (k - 1) + m (9 - k) leaves out of one, and per node of the group that is least, 15/9, for k = m = 8. All nodes but
/// perhaps the root are in groups.
inline constexpr uint64_t node_bound(uint64_t leaves) { return leaves == 0 ? 0 : 1 + 3 * leaves / 5; }

/// Bytes of the largest structure over `primitives`, a multiple of structure_alignment.
uint64_t largest_structure(uint64_t primitives, StructureKind kind, const BuildSettings& settings);

}  // namespace rayloom::accel
