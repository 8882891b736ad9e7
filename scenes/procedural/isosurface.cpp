#include "isosurface.h"

#include "shapes.h"

#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr uint32_t block = 16;  // points along a side of the largest cube that is left out where the surface is far
constexpr uint32_t least_block = 2;

struct Lattice {
  glm::vec3 origin;
  float cell;
  glm::uvec3 size;  ///< points along each axis

  uint32_t at(glm::uvec3 i) const { return (i.z * size.y + i.y) * size.x + i.x; }
  glm::vec3 position(glm::vec3 i) const { return origin + cell * i; }
};

/// Two cells wider than the bounds on every side, so that the surface never reaches the rim.
Lattice make_lattice(const Solid& solid, float cell) {
  const glm::vec3 cells = glm::ceil((solid.bounds.max - solid.bounds.min) / cell) + 5.0f;
  if (!(cells.x * cells.y * cells.z < 0x1p31f)) throw InputError("isosurface", "", "too many cells");
  return {solid.bounds.min - 2.0f * cell, cell, glm::uvec3(cells)};
}

template <typename Body>
void for_each_point(glm::uvec3 low, glm::uvec3 high, Body body) {
  for (uint32_t z = low.z; z < high.z; ++z) {
    for (uint32_t y = low.y; y < high.y; ++y) {
      for (uint32_t x = low.x; x < high.x; ++x) body(glm::uvec3(x, y, z));
    }
  }
}

/// Where the surface is far, the distance from the middle stands for all: only its sign will be looked at.
void sample_block(const Solid& solid, const Lattice& lattice, glm::uvec3 low, uint32_t side,
                  std::vector<float>& values) {
  const glm::uvec3 high = glm::min(low + side, lattice.size);
  if (low.x >= high.x || low.y >= high.y || low.z >= high.z) return;
  const glm::vec3 half = 0.5f * glm::vec3(high - low - 1u);
  const float middle = solid.distance(lattice.position(glm::vec3(low) + half));
  if (std::fabs(middle) > lattice.cell * (std::sqrt(glm::dot(half, half)) + 1)) {
    for_each_point(low, high, [&](glm::uvec3 i) { values[lattice.at(i)] = middle; });
  } else if (side > least_block) {
    for_each_point(glm::uvec3(0), glm::uvec3(2),
                   [&](glm::uvec3 i) { sample_block(solid, lattice, low + side / 2 * i, side / 2, values); });
  } else {
    for_each_point(low, high, [&](glm::uvec3 i) { values[lattice.at(i)] = solid.distance(lattice.position(i)); });
  }
}

std::vector<float> sample(const Solid& solid, const Lattice& lattice) {
  std::vector<float> values(size_t{lattice.size.x} * lattice.size.y * lattice.size.z);
  const glm::uvec3 blocks = (lattice.size + block - 1u) / block;
  parallel_for(uint64_t{blocks.x} * blocks.y * blocks.z, 1, [&](uint64_t begin, uint64_t end) {
    for (auto i = static_cast<uint32_t>(begin); i < end; ++i) {
      const glm::uvec3 low(i % blocks.x, i / blocks.x % blocks.y, i / blocks.x / blocks.y);
      sample_block(solid, lattice, block * low, block, values);
    }
  });
  return values;
}

/// The mesh under construction: the vertex of each cell, by the cell's lowest point.
class Nets {
 public:
  Nets(const Lattice& lattice, std::vector<float> values, Geometry& geometry)
      : lattice_(lattice), values_(std::move(values)), vertex_(values_.size(), 0), geometry_(geometry) {}

  void add_vertices() {
    for (uint32_t z = 0; z + 1 < lattice_.size.z; ++z) {
      for (uint32_t y = 0; y + 1 < lattice_.size.y; ++y) add_vertices_of_row(y, z);
    }
  }
  void add_faces() {
    for (const glm::uvec3 cell : cells_) {
      for (int axis = 0; axis < 3; ++axis) add_face(cell, axis);
    }
  }

 private:
  void add_vertices_of_row(uint32_t y, uint32_t z) {
    const float* rows[4];
    for (uint32_t k = 0; k < 4; ++k) rows[k] = &values_[lattice_.at({0, y + (k & 1), z + (k >> 1)})];
    const auto inside = [&](uint32_t x) {
      return (rows[0][x] < 0) + (rows[1][x] < 0) + (rows[2][x] < 0) + (rows[3][x] < 0);
    };
    int before = inside(0);
    for (uint32_t x = 0; x + 1 < lattice_.size.x; ++x) {
      const int after = inside(x + 1);
      if (before + after != 0 && before + after != 8) add_vertex({x, y, z});
      before = after;
    }
  }

  float value(glm::uvec3 i) const { return values_[lattice_.at(i)]; }
  static glm::uvec3 corner(uint32_t bits) { return {bits & 1, bits >> 1 & 1, bits >> 2}; }

  void add_vertex(glm::uvec3 cell) {
    uint32_t inside = 0;
    for (uint32_t k = 0; k < 8; ++k) inside |= (value(cell + corner(k)) < 0 ? 1u : 0u) << k;
    glm::vec3 sum(0);
    float crossings = 0;
    for (uint32_t a = 0; a < 8; ++a) {
      for (uint32_t b = a + 1; b < 8; ++b) {
        const bool edge = ((a ^ b) & ((a ^ b) - 1)) == 0;
        if (!edge || (inside >> a & 1) == (inside >> b & 1)) continue;
        const float va = value(cell + corner(a)), vb = value(cell + corner(b)), t = va / (va - vb);
        sum += glm::vec3(corner(a)) + t * (glm::vec3(corner(b)) - glm::vec3(corner(a)));
        crossings += 1;
      }
    }
    cells_.push_back(cell);
    vertex_[lattice_.at(cell)] = static_cast<uint32_t>(geometry_.positions.size());
    geometry_.positions.push_back(lattice_.position(glm::vec3(cell) + sum / crossings));
  }

  /// The edge from `low` along `axis` crosses the surface: a quad through the four cells around it.
  void add_face(glm::uvec3 low, int axis) {
    glm::uvec3 along(0), u(0), v(0);
    along[axis] = 1, u[(axis + 1) % 3] = 1, v[(axis + 2) % 3] = 1;
    const bool inside = value(low) < 0;
    if (inside == (value(low + along) < 0)) return;
    const uint32_t a = vertex_[lattice_.at(low - u - v)], b = vertex_[lattice_.at(low - v)];
    const uint32_t c = vertex_[lattice_.at(low)], d = vertex_[lattice_.at(low - u)];
    auto& indices = geometry_.indices;
    if (inside) {
      indices.insert(indices.end(), {a, b, c, a, c, d});
    } else {
      indices.insert(indices.end(), {a, d, c, a, c, b});
    }
  }

  const Lattice& lattice_;
  std::vector<float> values_;
  std::vector<uint32_t> vertex_;
  std::vector<glm::uvec3> cells_;  ///< those with a vertex
  Geometry& geometry_;
};

}  // namespace

void add_isosurface(Geometry& geometry, const Solid& solid, float cell) {
  const size_t first_vertex = geometry.positions.size(), first_index = geometry.indices.size();
  const Lattice lattice = make_lattice(solid, cell);
  Nets nets(lattice, sample(solid, lattice), geometry);
  nets.add_vertices();
  nets.add_faces();
  add_smooth_normals(geometry, first_vertex, first_index);
  for (size_t i = first_vertex; i < geometry.positions.size(); ++i) {
    geometry.uv0.emplace_back(geometry.positions[i].x, geometry.positions[i].y);
  }
}

void add_isosurface_of(Geometry& geometry, const Solid& solid, uint64_t triangles) {
  const glm::vec3 extent = solid.bounds.max - solid.bounds.min;
  float cell = std::max({extent.x, extent.y, extent.z}) / 20;
  for (;;) {
    Geometry attempt;
    add_isosurface(attempt, solid, cell);
    const uint64_t count = attempt.triangle_count();
    if (count >= triangles) {
      attempt.name = geometry.name, attempt.material = geometry.material;
      geometry = std::move(attempt);
      return;
    }
    // Triangles grow with the inverse square of the cells; a little more than asked for ends the search.
    cell *= 0.98f *
            std::sqrt(static_cast<float>(std::max<uint64_t>(count, triangles / 64)) / static_cast<float>(triangles));
  }
}

}  // namespace rayloom::scenes
