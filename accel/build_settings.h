#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace rayloom::accel {

/// How a structure's tree is made. All give the same closest hits (G3b); they differ in build time, trace speed, bytes.
enum class Builder : uint8_t {
  automatic,       ///< by build flags, see chosen_builder() in tree_builder.h
  binned_sah,      ///< the default: splits between bins by surface area
  spatial_splits,  ///< triangles cut where parts would overlap; then as reinsertion
  lbvh,            ///< the fastest to build: sorted along a Morton curve
  lbvh_treelets,   ///< lbvh, then small parts of it rearranged for the least cost
  reinsertion,     ///< for PREFER_FAST_TRACE: binned_sah, then subtrees moved to where they enlarge boxes least
};

/// Every builder but `automatic`.
std::span<const Builder> all_builders();
const char* builder_name(Builder builder);
std::optional<Builder> parse_builder(std::string_view name);

/// DXR's build flags (namespace build_flag), and choices that DXR leaves to the driver.
struct BuildSettings {
  constexpr BuildSettings(uint32_t build_flags, Builder chosen = Builder::automatic, bool open_instances = false)
      : flags(build_flags), builder(chosen), rebraid(open_instances) {}

  uint32_t flags;
  Builder builder;
  bool rebraid;  ///< top levels: instances that overlap others are split (rebraid.h); not with allow_update
};

}  // namespace rayloom::accel
