#pragma once

// The light of the sky: its radiance in a direction, and directions sampled in proportion to it.

#include <rayloom/shaders/scene_view.h>

#include <vector>

namespace rayloom::shaders {

/// `direction` is unit. Images are interpolated bilinearly, around the horizon and up to the poles.
float3 environment_radiance(const EnvironmentView& view, float3 direction);

struct DirectionSample {
  float3 direction;
  float pdf;  ///< per steradian
};

/// Chooses a cell in proportion to what it sends, and a direction uniformly in it. u in [0, 1).
DirectionSample sample_environment(const EnvironmentView& view, float2 u);
float environment_pdf(const EnvironmentView& view, float3 direction);

/// Host side: what an EnvironmentView points at.
struct EnvironmentTables {
  std::vector<float3> texels;
  std::vector<float> table;
  uint32_t rows = 0, columns = 0;
};

/// Decodes the image of an image environment. Pixels that are negative or not finite count as black; how many there
/// were is added to `bad_pixels`.
EnvironmentTables make_environment_tables(const scenes::Scene& scene, const scenes::Environment& environment,
                                          uint64_t& bad_pixels);

}  // namespace rayloom::shaders
