#pragma once

// Meshes of solids given by a distance function, by surface nets (Gibson 1998): a vertex in every grid cell the surface
// passes through, at the mean of where it crosses the cell's edges.

#include <rayloom/scenes/scene.h>

#include <functional>

namespace rayloom::scenes {

/// Where distance(p) < 0. Distances may be too short, but not too long: the function changes by at most 1 a metre.
struct Solid {
  Bounds bounds;                               ///< the solid lies inside
  std::function<float(glm::vec3 p)> distance;  ///< called from several threads
};

/// Appends the closed surface of the solid, facing outwards, with smooth normals and uv (x, y), from cells of `cell`
/// metres. InputError when it would need more than 2^31 cells.
void add_isosurface(Geometry& geometry, const Solid& solid, float cell);

/// The same with cells that give at least `triangles`, mostly not a fifth more; never larger than a 20th of the
/// longest side.
void add_isosurface_of(Geometry& geometry, const Solid& solid, uint64_t triangles);

}  // namespace rayloom::scenes
