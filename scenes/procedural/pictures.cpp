#include "pictures.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>

#include <algorithm>
#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr float pi = 3.14159265f;

uint8_t to_byte(float value) { return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f); }

/// color(p) for every pixel's centre p in [0, 1]^2, as bytes.
template <typename Color>
Pixels paint(uint32_t size, Color color) {
  Pixels pixels{size, size, {}, {}};
  pixels.bytes.reserve(size_t{4} * size * size);
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = 0; x < size; ++x) {
      const glm::vec2 p((static_cast<float>(x) + 0.5f) / static_cast<float>(size),
                        (static_cast<float>(y) + 0.5f) / static_cast<float>(size));
      const glm::vec4 c = color(p);
      for (int i = 0; i < 4; ++i) pixels.bytes.push_back(to_byte(c[i]));
    }
  }
  return pixels;
}

float lattice(int64_t x, int64_t y, uint32_t period, uint32_t seed) {
  const int64_t n = period;
  return unit_float(hash64(seed, (x % n + n) % n, (y % n + n) % n));
}

float smooth(float t) { return t * t * (3 - 2 * t); }
float mix(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace

float noise(glm::vec2 p, uint32_t period, uint32_t seed) {
  const float fx = std::floor(p.x), fy = std::floor(p.y);
  const auto x = static_cast<int64_t>(fx), y = static_cast<int64_t>(fy);
  const float tx = smooth(p.x - fx), ty = smooth(p.y - fy);
  return mix(mix(lattice(x, y, period, seed), lattice(x + 1, y, period, seed), tx),
             mix(lattice(x, y + 1, period, seed), lattice(x + 1, y + 1, period, seed), tx), ty);
}

float fractal_noise(glm::vec2 p, uint32_t period, uint32_t seed, int octaves) {
  float sum = 0, weight = 1, total = 0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * noise(p, period, seed + static_cast<uint32_t>(i));
    total += weight;
    p *= 2.0f, period *= 2, weight *= 0.5f;
  }
  return sum / total;
}

Pixels marble_tiles(uint32_t size) {
  return paint(size, [](glm::vec2 p) {
    const glm::vec2 tile = p * 2.0f, inside = tile - glm::floor(tile);
    const bool joint = std::min({inside.x, inside.y, 1 - inside.x, 1 - inside.y}) < 0.012f;
    const bool dark = (static_cast<int>(tile.x) + static_cast<int>(tile.y)) % 2 != 0;
    const float warp = fractal_noise(p * 8.0f, 8, 20, 5);
    const float vein = std::fabs(det::sin(2 * pi * (p.x + p.y + 1.5f * warp)));
    const float shade = joint ? 0.35f : (dark ? 0.50f : 0.80f) + 0.12f * (vein - 0.5f);
    return glm::vec4(shade, shade * 0.95f, shade * 0.87f, 1.0f);
  });
}

Pixels plaster(uint32_t size) {
  return paint(size, [](glm::vec2 p) {
    const float shade = 0.72f + 0.16f * fractal_noise(p * 8.0f, 8, 40, 6);
    return glm::vec4(shade, shade * 0.93f, shade * 0.80f, 1.0f);
  });
}

Pixels woven_pattern(uint32_t size) {
  return paint(size, [](glm::vec2 p) {
    const glm::vec2 cell = p * 4.0f, inside = cell - glm::floor(cell) - 0.5f;
    const float diamond = std::fabs(inside.x) + std::fabs(inside.y);
    const float thread = 0.06f * det::sin(2 * pi * 64 * p.x) * det::sin(2 * pi * 64 * p.y);
    const float shade = (diamond < 0.18f || std::fabs(diamond - 0.34f) < 0.04f ? 0.95f : 0.72f) + thread;
    return glm::vec4(glm::vec3(shade), 1.0f);
  });
}

Pixels leaf(uint32_t size) {
  return paint(size, [](glm::vec2 p) {
    const float along = 1 - p.y, across = std::fabs(p.x - 0.5f);
    const float width = 0.46f * det::sin(pi * det::pow(along, 0.7f)) * (0.94f + 0.06f * det::sin(60 * along));
    const float vein = across < 0.012f || std::fabs(det::sin(28 * (along - 0.8f * across))) < 0.08f ? 0.25f : 0.0f;
    const float shade = 0.75f + 0.25f * fractal_noise(p * 8.0f, 8, 60, 3) + vein;
    return glm::vec4(0.30f * shade, 0.52f * shade, 0.18f * shade, across < width ? 1.0f : 0.0f);
  });
}

Pixels leaf_spray(uint32_t size, uint32_t leaves, float width) {
  return paint(size, [=](glm::vec2 p) {
    const glm::vec2 at(p.x - 0.5f, 1 - p.y);  // from the twig's foot
    glm::vec4 color(0.25f, 0.17f, 0.10f, std::fabs(at.x) < 0.008f && at.y < 0.75f ? 1.0f : 0.0f);
    for (uint32_t i = 0; i < leaves; ++i) {
      const bool last = i + 1 == leaves;
      const float turn =
          last ? 0.0f
               : (i % 2 == 0 ? 1.0f : -1.0f) * (1.05f - 0.35f * static_cast<float>(i) / static_cast<float>(leaves));
      const auto [s, c] = det::sincos(turn);
      const glm::vec2 away = at - glm::vec2(0, 0.06f + 0.62f * static_cast<float>(i) / static_cast<float>(leaves));
      const float length = 3.4f * width, along = (s * away.x + c * away.y) / length, across = c * away.x - s * away.y;
      if (along <= 0 || along >= 1 || std::fabs(across) > width * det::sin(pi * det::pow(along, 0.75f))) continue;
      const float vein = std::fabs(across) < 0.05f * width ? 1.25f : 1.0f;
      const float shade = vein * (0.8f + 0.3f * unit_float(hash64(71u, i)) + 0.1f * along);
      color = glm::vec4(0.40f * shade, 0.58f * shade, 0.22f * shade, 1.0f);
    }
    return color;
  });
}

Pixels needle_spray(uint32_t size) {
  return paint(size, [](glm::vec2 p) {
    constexpr float needles = 26, reach = 0.4f;
    const float x = p.x - 0.5f, y = 1 - p.y;
    if (std::fabs(x) < 0.012f && y < 0.9f) return glm::vec4(0.30f, 0.22f, 0.14f, 1.0f);
    // Needles lean forward by one for two sideways, and get shorter towards the tip.
    const float foot = y - 0.55f * std::fabs(x), phase = needles * foot + (x < 0 ? 0.5f : 0.0f);
    const float limit =
        reach * (1.05f - 0.75f * foot) * (0.85f + 0.15f * unit_float(hash64(72u, static_cast<int>(phase + 64))));
    const bool needle = foot > 0.02f && foot < 0.93f && std::fabs(x) < limit && phase - std::floor(phase) < 0.45f;
    const float shade = 0.75f + 0.5f * std::fabs(x) / reach;
    return glm::vec4(0.28f * shade, 0.46f * shade, 0.24f * shade, needle ? 1.0f : 0.0f);
  });
}

}  // namespace rayloom::scenes
