#pragma once

// Triangles over a square grid of heights, cut into one geometry a material.

#include <rayloom/scenes/scene.h>

#include <functional>
#include <span>

namespace rayloom::scenes {

/// What the ground looks like at a point.
struct Cover {
  glm::vec3 color{1, 1, 1};  ///< linear
  uint8_t kind = 0;          ///< index into HeightGrid::materials
};

struct HeightGrid {
  float side = 1;                                           ///< metres along x and along z, centred on the origin
  uint32_t cells = 1;                                       ///< along either side; two triangles each
  std::vector<std::pair<std::string, uint32_t>> materials;  ///< name and material of each kind; at most 255
  // Both are called from several threads, with x and z in metres.
  std::function<float(glm::vec2 p)> height;
  std::function<Cover(glm::vec3 position, glm::vec3 normal)> cover;
};

/// Geometries of 2 * cells^2 triangles in all, facing up, with vertex normals, colours and uv in metres; kinds that do
/// not occur are left out. A cell is of the kind of its corner of least x and z.
std::vector<Geometry> make_height_grid(const HeightGrid& grid);

}  // namespace rayloom::scenes
