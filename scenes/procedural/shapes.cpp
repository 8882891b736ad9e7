#include "shapes.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/parallel.h>

#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr float two_pi = 6.28318531f;

glm::vec3 unit_or_up(glm::vec3 v) {
  const float length = std::sqrt(glm::dot(v, v));
  return length > 0 ? v / length : glm::vec3(0, 1, 0);
}

/// Vertex `column`, `row` of a grid that starts at vertex `first`.
struct Grid {
  uint32_t first, columns, rows;
  uint32_t at(uint32_t column, uint32_t row) const { return first + row * (columns + 1) + column; }
};

void compute_vertices(Geometry& geometry, const Grid& grid, const Surface& surface) {
  parallel_for(grid.rows + 1, 8, [&](uint64_t begin, uint64_t end) {
    for (auto row = static_cast<uint32_t>(begin); row < end; ++row) {
      const float v = static_cast<float>(row) / static_cast<float>(grid.rows);
      for (uint32_t column = 0; column <= grid.columns; ++column) {
        const float u = static_cast<float>(column) / static_cast<float>(grid.columns);
        const bool u_seam = surface.closed_u && column == grid.columns, v_seam = surface.closed_v && row == grid.rows;
        geometry.positions[grid.at(column, row)] = surface.position(u_seam ? 0 : u, v_seam ? 0 : v);
        geometry.uv0[grid.at(column, row)] = glm::vec2(u, v) * surface.uv_scale;
      }
    }
  });
}

/// Where a row of a grid is a single point, half of its triangles have no area and are left out.
void add_triangle(Geometry& geometry, uint32_t a, uint32_t b, uint32_t c) {
  const auto& p = geometry.positions;
  if (p[a] != p[b] && p[b] != p[c] && p[c] != p[a]) geometry.indices.insert(geometry.indices.end(), {a, b, c});
}

void add_triangles(Geometry& geometry, const Grid& grid) {
  for (uint32_t row = 0; row < grid.rows; ++row) {
    for (uint32_t column = 0; column < grid.columns; ++column) {
      const uint32_t a = grid.at(column, row), b = grid.at(column + 1, row);
      const uint32_t c = grid.at(column + 1, row + 1), d = grid.at(column, row + 1);
      add_triangle(geometry, a, b, c);
      add_triangle(geometry, a, c, d);
    }
  }
}

/// The faces around each vertex, by area.
void sum_faces(Geometry& geometry, size_t first_index) {
  for (size_t i = first_index; i < geometry.indices.size(); i += 3) {
    const uint32_t* v = &geometry.indices[i];
    const glm::vec3 a = geometry.positions[v[0]];
    const glm::vec3 face = glm::cross(geometry.positions[v[1]] - a, geometry.positions[v[2]] - a);
    for (int k = 0; k < 3; ++k) geometry.normals[v[k]] += face;
  }
}

void make_unit(Geometry& geometry, size_t first_vertex) {
  for (size_t i = first_vertex; i < geometry.normals.size(); ++i) geometry.normals[i] = unit_or_up(geometry.normals[i]);
}

/// The vertices on either side of a seam are one.
void share_normals(Geometry& geometry, uint32_t a, uint32_t b) {
  geometry.normals[a] = geometry.normals[b] = geometry.normals[a] + geometry.normals[b];
}

void smooth_normals(Geometry& geometry, const Grid& grid, size_t first_index, const Surface& surface) {
  sum_faces(geometry, first_index);
  for (uint32_t row = 0; surface.closed_u && row <= grid.rows; ++row) {
    share_normals(geometry, grid.at(0, row), grid.at(grid.columns, row));
  }
  for (uint32_t column = 0; surface.closed_v && column <= grid.columns; ++column) {
    share_normals(geometry, grid.at(column, 0), grid.at(column, grid.rows));
  }
  make_unit(geometry, grid.first);
}

}  // namespace

void add_smooth_normals(Geometry& geometry, size_t first_vertex, size_t first_index) {
  geometry.normals.resize(geometry.positions.size(), glm::vec3(0));
  sum_faces(geometry, first_index);
  make_unit(geometry, first_vertex);
}

void add_surface(Geometry& geometry, const Surface& surface) {
  const Grid grid{static_cast<uint32_t>(geometry.positions.size()), surface.columns, surface.rows};
  const size_t vertices = geometry.positions.size() + size_t{surface.columns + 1} * (surface.rows + 1);
  const size_t first_index = geometry.indices.size();
  geometry.positions.resize(vertices);
  geometry.normals.resize(vertices, glm::vec3(0));
  geometry.uv0.resize(vertices);
  geometry.indices.reserve(first_index + size_t{6} * surface.columns * surface.rows);
  compute_vertices(geometry, grid, surface);
  add_triangles(geometry, grid);
  smooth_normals(geometry, grid, first_index, surface);
}

void add_quad(Geometry& geometry, const glm::vec3 (&corners)[4], glm::vec2 uv_scale) {
  const auto first = static_cast<uint32_t>(geometry.positions.size());
  const glm::vec3 normal = unit_or_up(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  const glm::vec2 uvs[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int i = 0; i < 4; ++i) {
    geometry.positions.push_back(corners[i]);
    geometry.normals.push_back(normal);
    geometry.uv0.push_back(uvs[i] * uv_scale);
  }
  geometry.indices.insert(geometry.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
}

void add_box(Geometry& geometry, glm::vec3 a, glm::vec3 b) {
  const glm::vec3 size = b - a;
  const glm::vec2 xy(size.x, size.y), zy(size.z, size.y), xz(size.x, size.z);
  add_quad(geometry, {{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}}, xy);
  add_quad(geometry, {{b.x, a.y, a.z}, {a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}}, xy);
  add_quad(geometry, {{b.x, a.y, b.z}, {b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}}, zy);
  add_quad(geometry, {{a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z}}, zy);
  add_quad(geometry, {{a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z}, {a.x, b.y, a.z}}, xz);
  add_quad(geometry, {{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}}, xz);
}

void add_lathe(Geometry& geometry, std::span<const glm::vec2> profile, uint32_t segments) {
  const auto rows = static_cast<uint32_t>(profile.size() - 1);
  Surface surface{segments, rows, true, false, glm::vec2(1), {}};
  surface.position = [&](float u, float v) {
    const auto point = profile[static_cast<size_t>(v * static_cast<float>(rows) + 0.5f)];
    const auto [s, c] = det::sincos(two_pi * u);
    return glm::vec3(point.x * s, point.y, point.x * c);
  };
  add_surface(geometry, surface);
}

}  // namespace rayloom::scenes
