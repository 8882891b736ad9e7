#include "atrium_parts.h"

#include "pictures.h"
#include "shapes.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rayloom::scenes::atrium {
namespace {

constexpr float pi = 3.14159265f;
constexpr float half_span = 1.18f;  // inner radius of an arch

Geometry part(const char* name, uint32_t material) {
  Geometry geometry;
  geometry.name = name;
  geometry.material = material;
  return geometry;
}

/// Twenty flutes, shallow towards both ends, on a shaft with entasis.
glm::vec3 fluted_shaft(float u, float v, float bottom, float top) {
  const float ends = std::min(1.0f, 12 * std::min(v, 1 - v));
  const float flute = std::fabs(det::sin(pi * 20 * u));
  const float radius = (0.27f - 0.045f * v * v) * (1 - 0.09f * ends * flute);
  const auto [s, c] = det::sincos(2 * pi * u);
  return {radius * s, bottom + (top - bottom) * v, radius * c};
}

/// A ring of `count` profile points bulging between two radii: half a torus.
void add_torus(Geometry& geometry, float radius, float bulge, float y, uint32_t detail) {
  std::array<glm::vec2, 17> profile;
  for (size_t i = 0; i < profile.size(); ++i) {
    const auto [s, c] = det::sincos(pi * (static_cast<float>(i) / 16 - 0.5f));
    profile[i] = {radius + bulge * c, y + bulge * s};
  }
  add_lathe(geometry, profile, 64 * detail);
}

/// Leaf `index` of a bush: a quad whose root lies on a stem and whose tip points outwards and up.
void add_leaf(Geometry& geometry, size_t index, float height, uint32_t seed) {
  const auto random = [&](uint32_t what) { return unit_float(hash64(seed, index, what)); };
  const float up = random(0), spread = height * 0.38f * det::sin(pi * (0.1f + 0.85f * up)) * std::sqrt(random(1));
  const float around = 2 * pi * random(2), tilt = 0.9f * (random(3) - 0.25f), size = 0.09f + 0.07f * random(4);
  const auto [s, c] = det::sincos(around);
  const auto [st, ct] = det::sincos(tilt);
  const glm::vec3 root(spread * s, height * (0.08f + 0.9f * up), spread * c);
  const glm::vec3 along(ct * s, st, ct * c), across(-c, 0, s);
  const glm::vec3 wide = across * (0.4f * size), tip = along * size;
  const glm::vec3 corners[4] = {root - wide, root + wide, root + wide + tip, root - wide + tip};
  const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[3] - corners[0]);
  const glm::vec2 uvs[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  for (size_t i = 0; i < 4; ++i) {
    geometry.positions[4 * index + i] = corners[i];
    geometry.normals[4 * index + i] = normal / std::sqrt(glm::dot(normal, normal));
    geometry.uv0[4 * index + i] = uvs[i];
  }
  const auto first = static_cast<uint32_t>(4 * index);
  const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
  for (size_t i = 0; i < 6; ++i) geometry.indices[6 * index + i] = first + order[i];
}

}  // namespace

Geometry column(uint32_t detail, uint32_t material) {
  Geometry geometry = part("column", material);
  constexpr float shaft_bottom = 0.36f, shaft_top = column_height - 0.42f;
  add_box(geometry, {-0.36f, 0, -0.36f}, {0.36f, 0.14f, 0.36f});
  add_torus(geometry, 0.27f, 0.06f, 0.20f, detail);
  add_torus(geometry, 0.26f, 0.035f, 0.30f, detail);
  Surface shaft{160 * detail, 56 * detail, true, false, {2, 6}, {}};
  shaft.position = [](float u, float v) { return fluted_shaft(u, v, shaft_bottom, shaft_top); };
  add_surface(geometry, shaft);
  add_torus(geometry, 0.225f, 0.03f, shaft_top + 0.02f, detail);
  const std::array<glm::vec2, 6> bell = {{{0.22f, shaft_top},
                                          {0.225f, shaft_top + 0.1f},
                                          {0.25f, shaft_top + 0.18f},
                                          {0.30f, shaft_top + 0.25f},
                                          {0.36f, shaft_top + 0.29f},
                                          {0.37f, shaft_top + 0.3f}}};
  add_lathe(geometry, bell, 64 * detail);
  add_box(geometry, {-0.38f, shaft_top + 0.3f, -0.38f}, {0.38f, column_height, 0.38f});
  return geometry;
}

Geometry arch(uint32_t detail, uint32_t material) {
  Geometry geometry = part("arch", material);
  Surface band{96 * detail, 24 * detail, false, false, {6, 1}, {}};
  band.position = [](float u, float v) {
    const auto [s, c] = det::sincos(pi * u);
    const float z = 0.31f * (1 - 2 * v);
    const float edge = std::fabs(1 - 2 * v);
    const float radius = half_span + (edge > 0.75f ? 0.11f : edge > 0.6f ? 0.06f : 0.0f);
    return glm::vec3(radius * c, radius * s, z);
  };
  add_surface(geometry, band);
  for (const float side : {1.0f, -1.0f}) {
    Surface face{96 * detail, 6 * detail, false, false, {6, 1}, {}};
    face.position = [side](float u, float v) {
      const auto [s, c] = det::sincos(pi * (side > 0 ? u : 1 - u));
      const float radius = half_span + 0.11f + (arch_rise - half_span - 0.11f) * (1 - v);
      return glm::vec3(radius * c, radius * s, side * (0.31f + 0.02f * det::sin(pi * v)));
    };
    add_surface(geometry, face);
  }
  return geometry;
}

Geometry spandrel(uint32_t detail, float height, uint32_t material) {
  Geometry geometry = part("spandrel", material);
  for (const float side : {1.0f, -1.0f}) {
    Surface wall{64 * detail, 8, false, false, {bay, height}, {}};
    wall.position = [side, height](float u, float v) {
      const auto [s, c] = det::sincos(pi * (side > 0 ? 1 - u : u));
      const glm::vec2 inner(half_span * c, half_span * s);
      // Outwards along the ray from the centre to the rectangle's rim.
      const float to_side = std::fabs(c) > 1e-6f ? bay / 2 / std::fabs(c) : 1e6f;
      const float to_top = s > 1e-6f ? height / s : 1e6f;
      const glm::vec2 rim = std::min(to_side, to_top) * glm::vec2(c, s);
      return glm::vec3(inner + (rim - inner) * v, side * 0.26f);
    };
    add_surface(geometry, wall);
  }
  return geometry;
}

Geometry vault(uint32_t detail, float length, float width, uint32_t material) {
  Geometry geometry = part("vault", material);
  const auto coffers = static_cast<float>(static_cast<int>(length / 1.0f));
  Surface barrel{static_cast<uint32_t>(coffers) * 12 * detail, 60 * detail, false, false, {length, width}, {}};
  barrel.position = [=](float u, float v) {
    const glm::vec2 cell(u * coffers, v * 5);
    const glm::vec2 inside = glm::abs(cell - glm::floor(cell) - 0.5f);
    const float depth = std::max(inside.x, inside.y) < 0.30f ? 0.16f : std::max(inside.x, inside.y) < 0.38f ? 0.08f : 0;
    const auto [s, c] = det::sincos(pi * (0.06f + 0.88f * v));
    const float radius = width / 2 + depth;
    return glm::vec3((u - 0.5f) * length, 0.55f * radius * s, -radius * c);
  };
  add_surface(geometry, barrel);
  return geometry;
}

Geometry drape(uint32_t detail, float width, float drop, uint32_t seed, uint32_t material) {
  Geometry geometry = part("drape", material);
  Surface cloth{164 * detail, 164 * detail, false, false, {2, 2 * drop / width}, {}};
  cloth.position = [=](float u, float v) {
    const float hang = 1 - v;
    const float sag = 0.28f * (1 - hang) * 4 * u * (1 - u) + 0.5f * hang * u * (1 - u);
    const float phase = 2 * pi * noise({4 * u, 3 * hang}, 8, seed);
    const float fold = det::sin(2 * pi * 7 * u + phase) * (0.03f + 0.10f * hang);
    const float ripple = 0.05f * (fractal_noise({6 * u, 5 * hang}, 8, seed + 100, 4) - 0.5f);
    const float gather = 1 - 0.18f * hang;
    return glm::vec3((u - 0.5f) * width * gather, -drop * hang - sag, fold + ripple);
  };
  add_surface(geometry, cloth);
  return geometry;
}

Geometry pot(uint32_t detail, uint32_t material) {
  Geometry geometry = part("pot", material);
  const std::array<glm::vec2, 12> profile = {{{0.0f, 0.0f},
                                              {0.24f, 0.0f},
                                              {0.26f, 0.02f},
                                              {0.34f, 0.22f},
                                              {0.38f, 0.42f},
                                              {0.37f, 0.5f},
                                              {0.42f, 0.53f},
                                              {0.42f, 0.58f},
                                              {0.36f, 0.58f},
                                              {0.34f, 0.5f},
                                              {0.33f, 0.48f},
                                              {0.0f, 0.48f}}};
  add_lathe(geometry, profile, 64 * detail);
  return geometry;
}

Geometry foliage(uint32_t detail, float height, uint32_t seed, uint32_t material) {
  Geometry geometry = part("foliage", material);
  const size_t leaves = size_t{4000} * detail * detail;
  geometry.positions.resize(4 * leaves);
  geometry.normals.resize(4 * leaves);
  geometry.uv0.resize(4 * leaves);
  geometry.indices.resize(6 * leaves);
  parallel_for(leaves, 256, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) add_leaf(geometry, i, height, seed);
  });
  return geometry;
}

Geometry fountain(uint32_t detail, uint32_t material) {
  Geometry geometry = part("fountain", material);
  const std::array<glm::vec2, 20> profile = {
      {{0.0f, 0.0f},  {1.5f, 0.0f},   {1.55f, 0.05f}, {1.55f, 0.4f},  {1.6f, 0.45f}, {1.6f, 0.5f},  {1.4f, 0.5f},
       {1.38f, 0.2f}, {0.3f, 0.18f},  {0.16f, 0.3f},  {0.12f, 0.7f},  {0.15f, 1.0f}, {0.45f, 1.1f}, {0.7f, 1.25f},
       {0.72f, 1.3f}, {0.66f, 1.28f}, {0.4f, 1.15f},  {0.08f, 1.14f}, {0.05f, 1.4f}, {0.0f, 1.45f}}};
  add_lathe(geometry, profile, 128 * detail);
  return geometry;
}

Geometry ball(uint32_t detail, float radius, uint32_t material) {
  Geometry geometry = part("ball", material);
  Surface sphere{96 * detail, 48 * detail, true, false, {1, 1}, {}};
  sphere.position = [radius](float u, float v) {
    const auto [s, c] = det::sincos(2 * pi * u);
    const auto [sv, cv] = det::sincos(pi * v);
    const float ring = v == 0 || v == 1 ? 0 : radius * sv;  // the poles are single points
    return glm::vec3(ring * s, radius * (1 - cv), ring * c);
  };
  add_surface(geometry, sphere);
  return geometry;
}

}  // namespace rayloom::scenes::atrium
