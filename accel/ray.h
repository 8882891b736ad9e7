#pragma once

// What goes into a traversal and what comes out of it. Plain data: layouts equal DXR's where DXR has one.

#include <cstdint>
#include <limits>

namespace rayloom::accel {

/// A ray as HLSL's RayDesc lays it out (32 bytes). `direction` need not be normalised; t counts in its lengths.
struct Ray {
  float origin[3];
  float t_min;
  float direction[3];
  float t_max;
};
static_assert(sizeof(Ray) == 32);

/// Bits of TraceRay's RayFlags that traversal obeys; values are those of d3d12.h (checklist CAP-11).
namespace ray_flag {
inline constexpr uint32_t none = 0;
inline constexpr uint32_t force_opaque = 0x1;
inline constexpr uint32_t force_non_opaque = 0x2;
inline constexpr uint32_t accept_first_hit_and_end_search = 0x4;
inline constexpr uint32_t skip_closest_hit_shader = 0x8;  // not read by traversal
inline constexpr uint32_t cull_back_facing_triangles = 0x10;
inline constexpr uint32_t cull_front_facing_triangles = 0x20;
inline constexpr uint32_t cull_opaque = 0x40;
inline constexpr uint32_t cull_non_opaque = 0x80;
inline constexpr uint32_t skip_triangles = 0x100;
inline constexpr uint32_t skip_procedural_primitives = 0x200;
}  // namespace ray_flag

inline constexpr uint32_t hit_kind_triangle_front_face = 0xFE;
inline constexpr uint32_t hit_kind_triangle_back_face = 0xFF;
inline constexpr uint32_t no_index = 0xFFFFFFFFu;

enum class HitType : uint8_t { none, triangle, procedural };

/// The closest committed hit. `t` is the ray's t_max and the indices are `no_index` when `type` is `none`.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;  ///< weights of vertices 1 and 2; u, v >= 0 and u + v <= 1 (triangles only)
  uint32_t instance_index = no_index;
  uint32_t geometry_index = no_index;
  uint32_t primitive_index = no_index;
  uint32_t hit_kind = 0;
  HitType type = HitType::none;

  explicit operator bool() const { return type != HitType::none; }
};

}  // namespace rayloom::accel
