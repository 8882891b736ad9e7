#pragma once

// One room under two kinds of lamps that send out the same power: many small ones, which BSDF samples miss, and large
// panels, which light samples of sharp reflections miss. After the scene of Veach and Guibas 1995, "Optimally Combining
// Sampling Techniques for Monte Carlo Rendering".

#include <rayloom/scenes/scene.h>

namespace rayloom::bench {

inline constexpr const char* small_lamps = "small-lamps";
inline constexpr const char* large_lamps = "large-lamps";

/// One of the two above, or whatever scenes::load_scene knows.
scenes::Scene load_error_scene(const std::string& name);

}  // namespace rayloom::bench
