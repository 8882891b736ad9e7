#pragma once

// Triangle meshes of parametric surfaces. All windings are counter-clockwise seen from the side normals point to.

#include <rayloom/scenes/scene.h>

#include <functional>
#include <span>

namespace rayloom::scenes {

/// A grid of 2 * columns * rows triangles over u, v in [0, 1]; its front is the side of dP/du x dP/dv.
struct Surface {
  uint32_t columns = 1;
  uint32_t rows = 1;
  bool closed_u = false;     ///< u = 0 and u = 1 are the same points: normals are shared across the seam
  bool closed_v = false;     ///< the same for v
  glm::vec2 uv_scale{1, 1};  ///< texture coordinates are (u, v) times this
  std::function<glm::vec3(float u, float v)> position;
};

/// Area-weighted means of the faces from index `first_index` on, for the vertices from `first_vertex` on.
void add_smooth_normals(Geometry& geometry, size_t first_vertex, size_t first_index);

/// Appends the surface with smooth normals. Rows are computed in parallel.
void add_surface(Geometry& geometry, const Surface& surface);

/// The four corners counter-clockwise, seen from the front; uv (0,0), (1,0), (1,1), (0,1) times `uv_scale`.
void add_quad(Geometry& geometry, const glm::vec3 (&corners)[4], glm::vec2 uv_scale = glm::vec2(1));

/// A closed axis-aligned box, facing outwards; one unit of uv is one metre.
void add_box(Geometry& geometry, glm::vec3 min, glm::vec3 max);

/// A profile of (radius, height), bottom to top on the outside, turned about the y axis.
void add_lathe(Geometry& geometry, std::span<const glm::vec2> profile, uint32_t segments);

}  // namespace rayloom::scenes
