#pragma once

#include <rayloom/shaders/vector_math.h>

namespace rayloom::shaders {

/// Everything the first hit of a pixel tells. Indices are no_id where nothing was hit.
inline constexpr uint32_t no_id = ~0u;

struct AovPayload {
  uint64_t key = 0;
  float3 position{0};        ///< world space
  float ray_t = INFINITY;    ///< distance from the camera; infinite where nothing was hit
  float3 normal{0};          ///< geometric, on the viewer's side
  float facing = 0;          ///< 1 front, -1 back, 0 nothing hit
  float3 shading_normal{0};  ///< interpolated and normal-mapped
  float depth = INFINITY;    ///< along the viewing direction
  float3 albedo{0};          ///< base colour
  float occlusion = 1;       ///< as the file bakes it
  float2 uv{0};              ///< set 0
  uint32_t instance = no_id, geometry = no_id, primitive = no_id, material = no_id;

  uint64_t path_key() const { return key; }
  bool hit() const { return facing != 0; }
};

}  // namespace rayloom::shaders
