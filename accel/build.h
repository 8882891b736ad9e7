#pragma once

// Building acceleration structures. A structure is one contiguous block that holds no pointer into itself, so it may be
// moved or written to disk as bytes; a top-level block refers to bottom-level blocks by address only (TL-09).
// Same input, same bytes, for any thread count (DET-07).

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/build_settings.h>

#include <span>

namespace rayloom::accel {

/// Blocks start at multiples of this many bytes (D3D12_RAYTRACING_ACCELERATION_STRUCTURE_BYTE_ALIGNMENT).
inline constexpr uint64_t structure_alignment = 256;

/// Where the addresses inside instance descs live on the host: host pointer = base + address. A plain library user
/// leaves it null and stores host pointers as addresses; the runtime gives the base of its simulated device memory.
struct AddressSpace {
  const std::byte* base = nullptr;
  const std::byte* host(uint64_t address) const {
    return base ? base + address : reinterpret_cast<const std::byte*>(address);
  }
};

BuildSizes bottom_level_sizes(std::span<const TriangleGeometry> geometries, const BuildSettings& settings);
BuildSizes bottom_level_sizes(std::span<const AabbGeometry> geometries, const BuildSettings& settings);
BuildSizes top_level_sizes(uint64_t instance_count, const BuildSettings& settings);

/// Each build writes `result` (aligned to structure_alignment, at least result_bytes long) and returns the bytes it
/// used, the structure's current size. Throws InputError for input no rule gives a meaning to (an index out of range,
/// a count over its limit, memory too small), std::bad_alloc when scratch memory cannot be had.
uint64_t build_bottom_level(std::span<const TriangleGeometry> geometries, const BuildSettings& settings,
                            std::span<std::byte> result);
uint64_t build_bottom_level(std::span<const AabbGeometry> geometries, const BuildSettings& settings,
                            std::span<std::byte> result);
uint64_t build_top_level(std::span<const InstanceDesc> instances, AddressSpace addresses, const BuildSettings& settings,
                         std::span<std::byte> result);

/// Updates: new positions, boxes or instances in the tree that a build with allow_update made. `source` may be `result`
/// (then a failed update leaves it half updated) or lie apart from it, and stays as it is; `result` needs the source's
/// bytes, which are returned. Primitives that were inactive stay so. Throws InputError when `source` may not be
/// updated, or counts, flags or formats differ from the build's (UP-01 to UP-15).
uint64_t refit_bottom_level(std::span<const TriangleGeometry> geometries, const BuildSettings& settings,
                            const std::byte* source, std::span<std::byte> result);
uint64_t refit_bottom_level(std::span<const AabbGeometry> geometries, const BuildSettings& settings,
                            const std::byte* source, std::span<std::byte> result);
uint64_t refit_top_level(std::span<const InstanceDesc> instances, AddressSpace addresses, const BuildSettings& settings,
                         const std::byte* source, std::span<std::byte> result);

/// Builds what is left of a lazy structure (build_flag::lazy), or of all lazy ones that a top level refers to. After
/// that it is an ordinary structure, of the bytes that a build which is not lazy writes. Nothing may be traced through
/// it meanwhile. `block` is a structure; one that is not lazy stays as it is.
void complete_structure(std::byte* block, AddressSpace addresses = {});

/// Builds keep up to 256 MiB of their scratch memory for the next build of the process. This gives it back.
void release_build_scratch();

/// What a finished block says of itself.
struct StructureInfo {
  bool top_level = false;
  bool procedural = false;
  uint32_t build_flags = 0;
  Builder builder = Builder::automatic;  ///< the one that ran
  uint64_t bytes = 0;
  uint32_t depth = 0;  ///< of the wide tree, in nodes
  uint64_t nodes = 0, leaves = 0;
  uint64_t primitives = 0;         ///< counting inactive and degenerate ones (instances of a top level)
  uint64_t active_primitives = 0;  ///< those in leaves
  uint32_t geometries = 0;
  bool lazy = false;   ///< not complete, or a top level over such; depth, nodes and leaves are of its top, without cost
  uint64_t parts = 0;  ///< of a lazy bottom level
  uint64_t built_parts = 0;  ///< those that rays came to so far
  double sah_cost = 0;       ///< expected node visits + leaf visits of a random ray that hits the root box
  float bounds_min[3] = {}, bounds_max[3] = {};
};

/// Throws InputError when `block` is not a structure this version wrote.
StructureInfo structure_info(const std::byte* block);

}  // namespace rayloom::accel
