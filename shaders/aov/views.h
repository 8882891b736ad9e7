#pragma once

// Debug views: one AOV as a colour.

#include <rayloom/shaders/aov/payload.h>

#include <span>
#include <string_view>

namespace rayloom::shaders {

enum class AovView : uint8_t {
  depth,
  position,
  normal,
  shading_normal,
  albedo,
  occlusion,
  uv,
  distance,
  facing,
  instance_id,
  geometry_id,
  primitive_id,
  material_id
};

struct AovViewInfo {
  AovView view;
  std::string_view name;  ///< of the program that shows it
  std::string_view description;
};
std::span<const AovViewInfo> aov_views();

/// Normals map [-1, 1] to [0, 1], ids to random hues, facing to green (front) and red (back); depth, distance and
/// position are shown as they are, in metres. Black where nothing was hit.
float3 view_color(AovView view, const AovPayload& payload);

}  // namespace rayloom::shaders
