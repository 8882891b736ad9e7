#pragma once

// Tubes along a line: branches, strands of hair.

#include <rayloom/scenes/scene.h>

#include <span>

namespace rayloom::scenes {

/// Some vector at a right angle to the unit vector `v`, unit.
glm::vec3 beside(glm::vec3 v);

/// The unit vector `axis` leaning by `angle` (radians) to the side that is `side` turned by `around` about it.
glm::vec3 leaning(glm::vec3 axis, glm::vec3 side, float angle, float around);

/// The middle line, thickest at its foot. All arrays are as long; a ring of corners stands at every point but the last,
/// which is the tip.
struct TubePath {
  std::span<const glm::vec3> points;
  std::span<const glm::vec3> directions;  ///< unit, at the points
  float foot_radius;
  float tip_radius;  ///< what the radius would be at the tip if it did not end in a point

  uint32_t rings() const { return static_cast<uint32_t>(points.size() - 1); }
};

inline uint64_t tube_vertices(uint32_t rings, uint32_t sides) { return uint64_t{rings} * sides + 2; }
inline uint64_t tube_triangles(uint32_t rings, uint32_t sides) { return uint64_t{2} * rings * sides; }

/// Writes a closed tube, facing outwards, over the vertices from `vertex` and the triangles from `triangle` on; the
/// arrays (positions, normals, uv0, indices) are long enough. uv: around, and 4 along.
void write_tube(Geometry& geometry, uint64_t vertex, uint64_t triangle, const TubePath& path, uint32_t sides);

/// Makes room for it at the end.
void add_tube(Geometry& geometry, const TubePath& path, uint32_t sides);

}  // namespace rayloom::scenes
