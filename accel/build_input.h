#pragma once

// Geometry as a build reads it: spans of the caller's memory, never written, not kept after the build.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rayloom::accel {

enum class IndexFormat : uint8_t { none, uint16, uint32 };

namespace geometry_flag {
inline constexpr uint32_t none = 0;
inline constexpr uint32_t opaque = 0x1;
inline constexpr uint32_t no_duplicate_anyhit = 0x2;
inline constexpr uint32_t split = 0x80;  ///< in leaves only, set by the build: other leaves may name the triangle too
}  // namespace geometry_flag

namespace instance_flag {
inline constexpr uint32_t none = 0;
inline constexpr uint32_t triangle_cull_disable = 0x1;
inline constexpr uint32_t triangle_front_counterclockwise = 0x2;
inline constexpr uint32_t force_opaque = 0x4;
inline constexpr uint32_t force_non_opaque = 0x8;
}  // namespace instance_flag

namespace build_flag {
inline constexpr uint32_t none = 0;
inline constexpr uint32_t allow_update = 0x1;
inline constexpr uint32_t allow_compaction = 0x2;
inline constexpr uint32_t prefer_fast_trace = 0x4;
inline constexpr uint32_t prefer_fast_build = 0x8;
inline constexpr uint32_t minimize_memory = 0x10;
/// Not D3D12's: bottom levels of triangles are built part by part, when rays come to them (lazy_build.h). Other
/// structures are built as without it.
inline constexpr uint32_t lazy = 0x80000000;
}  // namespace build_flag

/// A 3x4 row-major affine map, translation in column 3 (DXR's FLOAT[3][4]).
using Transform3x4 = std::array<float, 12>;
inline constexpr Transform3x4 identity_transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// Triangle list. Vertex i is three floats at vertices + i * vertex_stride (any alignment).
struct TriangleGeometry {
  const std::byte* vertices = nullptr;
  uint64_t vertex_stride = 12;
  uint32_t vertex_count = 0;
  const std::byte* indices = nullptr;  ///< null when index_format is none: triangle i uses vertices 3i..3i+2
  IndexFormat index_format = IndexFormat::none;
  uint32_t triangle_count = 0;
  const float* transform = nullptr;  ///< 12 floats as Transform3x4, applied to the vertices at build; null: none
  uint32_t flags = geometry_flag::none;
};

/// Procedural boxes: min x y z, max x y z as six floats at boxes + i * stride. Stride 0 repeats one box (BI-21).
struct AabbGeometry {
  const std::byte* boxes = nullptr;
  uint64_t stride = 24;
  uint64_t box_count = 0;
  uint32_t flags = geometry_flag::none;
};

/// One instance, byte for byte D3D12_RAYTRACING_INSTANCE_DESC (64 bytes, TL-01).
struct InstanceDesc {
  float transform[3][4];
  uint32_t instance_id : 24;
  uint32_t instance_mask : 8;
  uint32_t instance_contribution_to_hit_group_index : 24;
  uint32_t flags : 8;
  uint64_t bottom_level_address;  ///< see AddressSpace in trace.h; 0: the instance is inactive
};
static_assert(sizeof(InstanceDesc) == 64);

/// Memory a build needs. Depends on counts and flags only, never on the data (PB-03), and grows with the counts
/// (PB-04).
struct BuildSizes {
  uint64_t result_bytes = 0;
  uint64_t scratch_bytes = 0;  ///< 0: builders take their scratch from the heap and return it
};

}  // namespace rayloom::accel
