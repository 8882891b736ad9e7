// Sculptures that are the image of a rectangle.

#include "shapes.h"
#include "statues.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>

#include <algorithm>
#include <cmath>

namespace rayloom::scenes::statues {
namespace {

constexpr float pi = 3.14159265f;

/// Columns around and rows from pole to pole, or around again, of at least `triangles`.
Surface grid_for(uint64_t triangles, float columns_a_row) {
  const float rows = std::sqrt(static_cast<float>(triangles) / (2 * columns_a_row)) + 2;
  Surface surface;
  surface.rows = static_cast<uint32_t>(rows);
  surface.columns = static_cast<uint32_t>(std::ceil(rows * columns_a_row));
  surface.closed_u = true;
  surface.uv_scale = {4, 4};
  return surface;
}

Geometry meshed(const Surface& surface) {
  Geometry geometry;
  add_surface(geometry, surface);
  return geometry;
}

/// Gielis' superformula with a = b = 1 and n2 = n3: radius at an angle.
struct Superformula {
  float lobes, n1, n2;
  float operator()(float angle) const {
    const auto [s, c] = det::sincos(0.25f * lobes * angle);
    const float sum = det::pow(std::fabs(c), n2) + det::pow(std::fabs(s), n2);
    return det::pow(sum, -1 / n1);
  }
};

glm::vec3 unit(glm::vec3 v) { return v / std::sqrt(glm::dot(v, v)); }

}  // namespace

Geometry supershape(uint64_t triangles, uint32_t seed) {
  const auto random = [&](uint32_t what) { return unit_float(hash64(seed, what, 1u)); };
  const Superformula around{3 + std::floor(6 * random(0)), 1.2f + 2 * random(1), 1.5f + 1.5f * random(2)};
  const Superformula up{2 + 2 * std::floor(3 * random(3)), 2 + 3 * random(4), 2 + random(5)};
  const float twist = (random(6) - 0.5f) * pi, taper = 0.35f * random(7);
  Surface surface = grid_for(triangles, 2);
  surface.position = [=](float u, float v) {
    const float latitude = pi * (v - 0.5f);
    const auto [sv, cv] = det::sincos(latitude);
    const float ru = around(2 * pi * u), rv = up(latitude);
    const auto [s, c] = det::sincos(2 * pi * u + twist * sv);
    const float ring = v == 0 || v == 1 ? 0 : ru * rv * cv * (1 - taper * sv);  // the poles are single points
    return glm::vec3(ring * s, 1.35f * rv * sv, ring * c);
  };
  return meshed(surface);
}

Geometry knot(uint64_t triangles, uint32_t seed) {
  constexpr float windings[5][3] = {{2, 3, 0.42f}, {3, 2, 0.38f}, {2, 5, 0.30f}, {3, 4, 0.28f}, {5, 2, 0.22f}};
  const float p = windings[seed % 5][0], q = windings[seed % 5][1], thick = windings[seed % 5][2];
  const auto random = [&](uint32_t what) { return unit_float(hash64(seed, what, 2u)); };
  const float ribs = 3 + std::floor(4 * random(0)), turns = 4 + std::floor(12 * random(1)),
              depth = 0.10f + 0.12f * random(2);
  Surface surface = grid_for(triangles, 0.2f);
  surface.closed_v = true;
  surface.position = [=](float u, float v) {
    const float t = 2 * pi * v;
    const auto [sp, cp] = det::sincos(p * t);
    const auto [sq, cq] = det::sincos(q * t);
    const glm::vec3 out(cp, sp, 0), around(-sp, cp, 0);  // the torus stands upright
    const glm::vec3 center = (2 + cq) * out + glm::vec3(0, 0, sq);
    const glm::vec3 along = unit(p * (2 + cq) * around + q * (glm::vec3(0, 0, cq) - sq * out));
    const glm::vec3 normal = cq * out + glm::vec3(0, 0, sq), side = glm::cross(along, normal);
    const auto [s, c] = det::sincos(2 * pi * u);
    const float rope = 1 + depth * det::cos(2 * pi * ribs * u + turns * t);
    return center + thick * rope * (c * normal + s * side);
  };
  return meshed(surface);
}

Geometry column(uint64_t triangles, uint32_t seed) {
  const auto random = [&](uint32_t what) { return unit_float(hash64(seed, what, 3u)); };
  const float lobes = 2 + std::floor(4 * random(0)), depth = 0.15f + 0.2f * random(1);
  const float turns = (random(2) < 0.5f ? -1.0f : 1.0f) * (1.5f + 3 * random(3));
  const float waves = 1 + std::floor(3 * random(4)), swell = 0.15f + 0.2f * random(5),
              lean = 0.25f * (random(6) - 0.5f);
  Surface surface = grid_for(triangles, 0.7f);
  surface.position = [=](float u, float v) {
    const auto [s, c] = det::sincos(2 * pi * u);
    const float ends = v == 0 || v == 1 ? 0 : det::pow(4 * v * (1 - v), 0.3f);  // closes like a cushion
    const float fluted = 1 - depth + depth * det::cos(lobes * 2 * pi * u + turns * pi * v);
    const float radius = 0.32f * ends * fluted * (1 - 0.35f * v + swell * det::sin(waves * 2 * pi * v + 0.6f));
    const float bend = lean * det::sin(2 * pi * v);
    return glm::vec3(radius * s + bend, 2 * v, radius * c);
  };
  return meshed(surface);
}

void fit(Geometry& geometry, float height, float width) {
  Bounds bounds;
  for (const glm::vec3& p : geometry.positions) bounds.add(p);
  const glm::vec3 extent = bounds.max - bounds.min;
  const float scale = std::min(height / extent.y, width / std::max(extent.x, extent.z));
  const glm::vec3 foot(0.5f * (bounds.min.x + bounds.max.x), bounds.min.y, 0.5f * (bounds.min.z + bounds.max.z));
  for (glm::vec3& p : geometry.positions) p = scale * (p - foot);
}

}  // namespace rayloom::scenes::statues
