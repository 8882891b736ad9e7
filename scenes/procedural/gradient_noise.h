#pragma once

// Gradient noise (Perlin 2002) with its slope, for heights, displacements and everything that must be smooth. Exact
// IEEE operations and integer hashes only: the same bits everywhere.

#include <rayloom/base/hash.h>

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace rayloom::scenes {

/// A value over the plane and its derivative along x and y.
struct Slope {
  float value = 0;
  glm::vec2 slope{0, 0};
};

/// Two numbers in [-1, 1) for a lattice point.
inline glm::vec2 lattice_vector(int32_t x, int32_t y, uint32_t seed) noexcept {
  const uint64_t key = (uint64_t{static_cast<uint32_t>(x)} << 32 | static_cast<uint32_t>(y)) + 0x9E3779B97F4A7C15u;
  const uint64_t hash = mix64(key ^ mix64(seed));
  return {static_cast<float>(static_cast<int16_t>(hash >> 48)) * 0x1p-15f,
          static_cast<float>(static_cast<int16_t>(hash >> 32)) * 0x1p-15f};
}

/// std::floor for |x| below 2^31, without a call where the instruction set has no rounding.
inline int32_t floor_int(float x) noexcept {
  const auto truncated = static_cast<int32_t>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

/// Noise of wavelength about 1.5 and values mostly within [-1, 1]; 0 at whole numbers. |p| below 2^30.
inline Slope gradient_noise(glm::vec2 p, uint32_t seed) noexcept {
  const int32_t x = floor_int(p.x), y = floor_int(p.y);
  const glm::vec2 f(p.x - static_cast<float>(x), p.y - static_cast<float>(y));
  const glm::vec2 u = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f), du = 30.0f * f * f * (f * (f - 2.0f) + 1.0f);
  const glm::vec2 ga = lattice_vector(x, y, seed), gb = lattice_vector(x + 1, y, seed);
  const glm::vec2 gc = lattice_vector(x, y + 1, seed), gd = lattice_vector(x + 1, y + 1, seed);
  const float a = glm::dot(ga, f), b = glm::dot(gb, f - glm::vec2(1, 0));
  const float c = glm::dot(gc, f - glm::vec2(0, 1)), d = glm::dot(gd, f - glm::vec2(1, 1));
  const float twist = a - b - c + d;
  const glm::vec2 blend = ga + u.x * (gb - ga) + u.y * (gc - ga) + u.x * u.y * (ga - gb - gc + gd);
  const glm::vec2 slope = blend + du * (glm::vec2(u.y, u.x) * twist + glm::vec2(b, c) - a);
  return {1.6f * (a + u.x * (b - a) + u.y * (c - a) + u.x * u.y * twist), 1.6f * slope};
}

/// 0 up to `low`, 1 from `high` on, smooth between.
inline float smooth_step(float low, float high, float x) noexcept {
  const float t = std::fmin(std::fmax((x - low) / (high - low), 0.0f), 1.0f);
  return t * t * (3 - 2 * t);
}

}  // namespace rayloom::scenes
