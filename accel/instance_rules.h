#pragma once

// What a ray's flags, an instance's and a geometry's make of a primitive that is hit: checklist rows OP, RF and CU.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/ray.h>

#include <array>
#include <cstddef>

namespace rayloom::accel {

enum class Outcome : uint8_t { commit, ask, cull };

/// Opacity is resolved in the order of Q-18: geometry, instance, ray, then culling. Where flags that exclude each other
/// come together, force_opaque wins (RF-19).
constexpr Outcome resolve_opacity(bool opaque, uint32_t instance_flags, uint32_t ray_flags) {
  if (instance_flags & instance_flag::force_non_opaque) opaque = false;
  if (instance_flags & instance_flag::force_opaque) opaque = true;
  if (ray_flags & ray_flag::force_non_opaque) opaque = false;
  if (ray_flags & ray_flag::force_opaque) opaque = true;
  if (ray_flags & (opaque ? ray_flag::cull_opaque : ray_flag::cull_non_opaque)) return Outcome::cull;
  return opaque ? Outcome::commit : Outcome::ask;
}

/// What flags of a ray and an instance make of triangles. Eight bytes, so that a copy is one move: processors wait
/// where a load takes what several stores wrote.
struct alignas(8) HitRules {
  Outcome outcome[2];     ///< by the geometry's opaque flag
  bool culled_facing[2];  ///< by "is front"
  bool swap_facing;
  bool accepts_all;  ///< every triangle hit, for rays without candidate function
  uint16_t unused = 0;

  HitRules() = default;
  constexpr HitRules(uint32_t instance_flags, uint32_t ray_flags)
      : outcome(), culled_facing(), swap_facing(), accepts_all() {
    for (const bool opaque : {false, true}) outcome[opaque] = resolve_opacity(opaque, instance_flags, ray_flags);
    const bool cull = !(instance_flags & instance_flag::triangle_cull_disable);
    swap_facing = instance_flags & instance_flag::triangle_front_counterclockwise;
    culled_facing[false] = cull && (ray_flags & ray_flag::cull_back_facing_triangles);
    culled_facing[true] = cull && (ray_flags & ray_flag::cull_front_facing_triangles);
    accepts_all = outcome[0] != Outcome::cull && outcome[1] != Outcome::cull && !culled_facing[0] && !culled_facing[1];
  }
};
static_assert(sizeof(HitRules) == 8);

/// The rules outside instances with flags, by the ray flags that matter, which are the lowest eight: most calls for a
/// single ray need nothing else, and to make them takes 40 instructions.
inline constexpr auto plain_rules = [] {
  static_assert(ray_flag::cull_non_opaque == 0x80, "the highest flag that HitRules reads");
  std::array<HitRules, 256> rules;
  for (uint32_t flags = 0; flags < rules.size(); ++flags) rules[flags] = HitRules(0, flags);
  return rules;
}();

/// Rules of one ray inside one instance, made once on entry.
struct InstanceRules {
  HitRules hits;
  const std::byte* instance;  ///< its record; null when a bottom level is traced directly
  uint32_t instance_index;

  InstanceRules() = default;
  InstanceRules(uint32_t index, uint32_t instance_flags, uint32_t ray_flags, const std::byte* record)
      : hits(instance_flags, ray_flags), instance(record), instance_index(index) {}
  /// Outside instances.
  explicit InstanceRules(uint32_t ray_flags)
      : hits(plain_rules[ray_flags & 0xFF]), instance(nullptr), instance_index(0) {}

  Outcome outcome_of(uint32_t geometry_word) const { return hits.outcome[geometry_word >> 24 & geometry_flag::opaque]; }
};

inline constexpr uint32_t geometry_index(uint32_t geometry_word) { return geometry_word & 0xFFFFFFu; }

}  // namespace rayloom::accel
