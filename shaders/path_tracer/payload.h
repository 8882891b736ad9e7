#pragma once

#include <rayloom/shaders/sampler.h>
#include <rayloom/shaders/vector_math.h>

namespace rayloom::shaders {

/// Between ray generation, which walks the path, and the hit and miss shaders, which say what a vertex of it does.
struct PathPayload {
  // To the shaders.
  Sampler sampler;        ///< advanced by what they draw
  float pdf;              ///< with which the ray's direction was sampled, per steradian; 0: it comes from the camera.
                          ///< Back: of the next direction; 0: the path ends
  uint32_t bounces_left;  ///< 0: only what is emitted towards the ray counts

  // Back from them.
  float3 emitted;      ///< towards the ray, with its MIS weight
  uint32_t hit;        ///< 0: the ray left the scene
  float3 weight;       ///< BSDF times cosine over pdf of the next direction
  float roulette;      ///< a random number in [0, 1) for Russian roulette
  float3 origin;       ///< of the next ray and the shadow ray
  float shadow_t_max;  ///< 0: no shadow ray
  float3 direction;    ///< of the next ray
  float3 shadow;       ///< direction of the shadow ray
  float3 direct;       ///< what the light sends through this vertex if the shadow ray meets nothing

  uint64_t path_key() const { return sampler.path_key(); }
};

}  // namespace rayloom::shaders
