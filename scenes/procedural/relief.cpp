#include "relief.h"

#include <algorithm>

namespace rayloom::scenes {
namespace {

constexpr int swell_octaves = 3, ridge_octaves = 7, gully_octaves = 5;

Slope operator*(const Slope& a, const Slope& b) { return {a.value * b.value, a.value * b.slope + b.value * a.slope}; }
Slope operator*(float a, const Slope& b) { return {a * b.value, a * b.slope}; }
Slope operator+(const Slope& a, const Slope& b) { return {a.value + b.value, a.slope + b.slope}; }

/// smooth_step of a sloped value.
Slope smooth_step(float low, float high, const Slope& x) {
  const float t = std::clamp((x.value - low) / (high - low), 0.0f, 1.0f);
  return {t * t * (3 - 2 * t), 6 * t * (1 - t) / (high - low) * x.slope};
}

/// x where it is high, `floor` where it is low, rounded over `width`: sediment fills the valleys.
Slope filled(const Slope& x, float floor, float width) {
  const float t = (x.value - floor) / width;
  if (t >= 1) return x;
  if (t <= -1) return {floor + 0.04f * (x.value - floor + width), 0.04f * x.slope};
  const float s = 0.5f * (t + 1);  // slope 0.04 below, 1 above, quadratic between
  return {floor + width * (0.96f * s * s + 0.04f * (t + 1)), (0.96f * s + 0.04f) * x.slope};
}

/// cos(2 pi x) to 2 %, with its derivative.
Slope wave(float x, glm::vec2 direction) {
  x -= static_cast<float>(floor_int(x + 0.5f));
  const float p = 1 - 4 * std::fabs(x);
  const float derivative = (x < 0 ? 6.0f : -6.0f) * (1 - p * p);
  return {p * (1.5f - 0.5f * p * p), derivative * direction};
}

/// Waves along `direction` whose phase starts anew in each cell of a jittered grid, blended: stripes that fork and end.
Slope stripes(glm::vec2 p, glm::vec2 direction, uint32_t seed) {
  const int32_t x = floor_int(p.x), y = floor_int(p.y);
  Slope sum;
  float total = 0;
  for (int32_t j = y - 1; j <= y + 1; ++j) {
    for (int32_t i = x - 1; i <= x + 1; ++i) {
      const glm::vec2 away = p - glm::vec2(i, j) - 0.5f - 0.25f * lattice_vector(i, j, seed);
      const float nearness = std::max(0.0f, 1 - glm::dot(away, away) / (1.25f * 1.25f));
      const float weight = nearness * nearness * nearness;
      sum = sum + weight * wave(glm::dot(away, direction), direction);
      total += weight;
    }
  }
  return (1 / total) * sum;
}

}  // namespace

Slope Relief::swell(glm::vec2 p) const {
  Slope sum;
  float frequency = 1 / 1700.0f, amplitude = 1;
  for (uint32_t i = 0; i < swell_octaves; ++i) {
    const Slope n = gradient_noise(p * frequency, seed_ * 64 + i);
    sum = sum + amplitude * Slope{n.value, n.slope * frequency};
    frequency *= 2, amplitude *= 0.45f;
  }
  return sum;
}

Slope Relief::ridges(glm::vec2 p) const {
  Slope sum;
  float frequency = 1 / 1100.0f, amplitude = 0.5f, weight = 1;
  glm::vec2 cosine_sine(1, 0);  // each octave is turned, or the lattice would show
  for (uint32_t i = 0; i < ridge_octaves; ++i) {
    const auto [c, s] = std::pair(cosine_sine.x, cosine_sine.y);
    const glm::vec2 turned(c * p.x - s * p.y, s * p.x + c * p.y);
    const Slope n = gradient_noise(turned * frequency, seed_ * 64 + 16 + i);
    const float ridge = std::max(0.0f, 1 - 1.4f * std::fabs(n.value));
    const float steep = ridge > 0 ? (n.value < 0 ? 2.8f : -2.8f) * ridge * frequency : 0;
    const glm::vec2 slope(c * n.slope.x + s * n.slope.y, c * n.slope.y - s * n.slope.x);
    sum = sum + amplitude * weight * Slope{ridge * ridge, steep * slope};
    weight = std::clamp(1.6f * ridge * ridge * weight, 0.0f, 1.0f);
    frequency *= 2.1f, amplitude *= 0.46f;
    cosine_sine = {0.8f * c - 0.6f * s, 0.6f * c + 0.8f * s};
  }
  return sum;
}

void Relief::carve_gullies(glm::vec2 p, Slope& ground) const {
  float length = 210;
  for (uint32_t i = 0; i < gully_octaves; ++i) {
    const float steepness = std::sqrt(glm::dot(ground.slope, ground.slope));
    if (steepness > 0) {
      const glm::vec2 across = glm::vec2(-ground.slope.y, ground.slope.x) / steepness;
      const float depth = 0.085f * length * scenes::smooth_step(0.08f, 0.7f, steepness);
      const Slope gully = stripes(p / length, across, seed_ * 64 + 48 + i);
      ground = ground + depth * Slope{gully.value, gully.slope / length};
    }
    length *= 0.5f;
  }
}

float Relief::height(glm::vec2 p) const {
  const Slope wide = swell(p);
  const Slope mountains = smooth_step(-0.35f, 0.75f, wide);
  const Slope high = mountains * ridges(p);
  Slope ground = 680.0f * high + 70.0f * wide + Slope{-20, {0, 0}};
  ground = filled(ground, -22, 75);
  carve_gullies(p, ground);
  return ground.value;
}

}  // namespace rayloom::scenes
