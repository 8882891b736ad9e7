#pragma once

// The heights of a mountain landscape with lakes, as a function of the place: ridged noise (Musgrave 1993) on a slow
// swell, then gullies that run down the slopes, at ever smaller scales, each following the slope the larger ones left.

#include <rayloom/scenes/procedural/gradient_noise.h>

namespace rayloom::scenes {

class Relief {
 public:
  explicit Relief(uint32_t seed) : seed_(seed) {}

  /// Metres above the lakes' level at `p`, metres.
  float height(glm::vec2 p) const;

 private:
  // Slopes steer the gullies only, so what is small or slow is left out of them.
  Slope swell(glm::vec2 p) const;
  Slope ridges(glm::vec2 p) const;
  void carve_gullies(glm::vec2 p, Slope& ground) const;

  uint32_t seed_;
};

}  // namespace rayloom::scenes
