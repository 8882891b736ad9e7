#pragma once

// Textures made by a program, and the noise they are made of.

#include <rayloom/scenes/image.h>

#include <glm/glm.hpp>

namespace rayloom::scenes {

/// Value noise in [0, 1], smooth, with lattice period `period` on both axes.
float noise(glm::vec2 p, uint32_t period, uint32_t seed);
/// Octaves of it, each of twice the frequency and half the weight; in [0, 1].
float fractal_noise(glm::vec2 p, uint32_t period, uint32_t seed, int octaves);

Pixels marble_tiles(uint32_t size);   ///< two by two tiles with joints, sRGB
Pixels plaster(uint32_t size);        ///< sRGB
Pixels woven_pattern(uint32_t size);  ///< grey stripes and diamonds to be coloured, sRGB
Pixels leaf(uint32_t size);           ///< one leaf, alpha 0 around it, sRGB

/// Pairs of leaves on a twig that grows from the middle of the lower edge, alpha 0 around them, sRGB. `width`: half of
/// a leaf's, in parts of the picture's.
Pixels leaf_spray(uint32_t size, uint32_t leaves, float width);
Pixels needle_spray(uint32_t size);  ///< the same with needles

}  // namespace rayloom::scenes
