#include "tube.h"

#include <rayloom/base/det_math.h>

#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr float pi = 3.14159265f;

glm::vec3 unit(glm::vec3 v) { return v / std::sqrt(glm::dot(v, v)); }

struct Writer {
  Geometry& geometry;
  uint64_t vertex, index;

  uint32_t add_vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 uv) {
    geometry.positions[vertex] = position;
    geometry.normals[vertex] = normal;
    geometry.uv0[vertex] = uv;
    return static_cast<uint32_t>(vertex++);
  }
  void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    for (const uint32_t corner : {a, b, c}) geometry.indices[index++] = corner;
  }
};

void write_rings(Writer& writer, const TubePath& path, uint32_t sides) {
  glm::vec3 side = beside(path.directions[0]);
  for (uint32_t ring = 0; ring < path.rings(); ++ring) {
    const glm::vec3 along = path.directions[ring];
    side = unit(side - glm::dot(side, along) * along);  // no twist from one ring to the next
    const float t = static_cast<float>(ring) / static_cast<float>(path.rings());
    const float radius = path.foot_radius + t * (path.tip_radius - path.foot_radius);
    for (uint32_t i = 0; i < sides; ++i) {
      const float turn = static_cast<float>(i) / static_cast<float>(sides);
      const glm::vec3 out = unit(leaning(along, side, pi / 2, 2 * pi * turn));
      writer.add_vertex(path.points[ring] + radius * out, out, {turn, 4 * t});
    }
  }
}

}  // namespace

glm::vec3 beside(glm::vec3 v) {
  return unit(glm::cross(v, std::fabs(v.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1)));
}

glm::vec3 leaning(glm::vec3 axis, glm::vec3 side, float angle, float around) {
  const auto [s, c] = det::sincos(angle);
  const auto [sa, ca] = det::sincos(around);
  return c * axis + s * (ca * side + sa * glm::cross(axis, side));
}

void write_tube(Geometry& geometry, uint64_t vertex, uint64_t triangle, const TubePath& path, uint32_t sides) {
  Writer writer{geometry, vertex, 3 * triangle};
  const uint32_t foot = writer.add_vertex(path.points.front(), -path.directions.front(), {0.5f, 0});
  write_rings(writer, path, sides);
  const uint32_t tip = writer.add_vertex(path.points.back(), path.directions.back(), {0.5f, 4});
  const uint32_t first = foot + 1, last = first + (path.rings() - 1) * sides;
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t next = (i + 1) % sides;
    writer.add_triangle(foot, first + next, first + i);
    for (uint32_t ring = first; ring < last; ring += sides) {
      writer.add_triangle(ring + i, ring + next, ring + sides + next);
      writer.add_triangle(ring + i, ring + sides + next, ring + sides + i);
    }
    writer.add_triangle(last + i, last + next, tip);
  }
}

void add_tube(Geometry& geometry, const TubePath& path, uint32_t sides) {
  const uint64_t vertex = geometry.positions.size(), triangle = geometry.triangle_count();
  const uint64_t vertices = vertex + tube_vertices(path.rings(), sides);
  geometry.positions.resize(vertices), geometry.normals.resize(vertices), geometry.uv0.resize(vertices);
  geometry.indices.resize(3 * (triangle + tube_triangles(path.rings(), sides)));
  write_tube(geometry, vertex, triangle, path, sides);
}

}  // namespace rayloom::scenes
