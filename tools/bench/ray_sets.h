#pragma once

// The rays that tracers are compared with: those of one path vertex, from the scene's camera on.

#include <rayloom/tools/bench/our_structure.h>

#include <string>
#include <vector>

namespace rayloom::bench {

using Rays = std::vector<accel::Ray>;

/// Infinite t_max, or the way to the light or the occlusion distance; t_min is 0: origins lie off the surface.
struct RaySets {
  Rays primary;   ///< through pixel centres, pixels in Morton order
  Rays bounce;    ///< a cosine-distributed ray from each primary hit, in that order
  Rays ambient;   ///< the same directions over 10 % of the scene's diagonal
  Rays shadow;    ///< to points of a small area light
  Rays shuffled;  ///< bounce in random order
};

/// `size` x `size` pixels. The same sets for any tree, thread count and instruction set.
RaySets make_ray_sets(const BenchScene& scene, const OurStructure& structure, uint32_t size);

/// The pixel at place `index` of the Morton curve.
struct MortonPixel {
  uint32_t x, y;
};
MortonPixel morton_pixel(uint64_t index);

}  // namespace rayloom::bench
