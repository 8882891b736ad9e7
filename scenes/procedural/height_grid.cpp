#include "height_grid.h"

#include <rayloom/base/parallel.h>

#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr uint64_t rows_at_once = 8;

/// The ground at every grid point, row by row.
struct Points {
  uint32_t side;  ///< points along a side
  float step, origin;
  std::vector<float> heights;
  std::vector<Cover> covers;

  glm::vec3 position(uint32_t i) const {
    return {origin + step * static_cast<float>(i % side), heights[i], origin + step * static_cast<float>(i / side)};
  }
  /// Of the plane through the neighbours; at the rim through the point itself and one neighbour.
  glm::vec3 normal(uint32_t i) const {
    const auto rise = [&](uint32_t at, uint32_t stride) {
      const uint32_t before = at == 0 ? i : i - stride, after = at + 1 == side ? i : i + stride;
      return (heights[after] - heights[before]) / (step * static_cast<float>((after - before) / stride));
    };
    const glm::vec3 up(-rise(i % side, 1), 1, -rise(i / side, side));
    return up / std::sqrt(glm::dot(up, up));
  }
};

template <typename Body>
void for_each_point(const Points& points, Body body) {
  parallel_for(points.side, rows_at_once, [&](uint64_t begin, uint64_t end) {
    for (auto i = static_cast<uint32_t>(begin) * points.side; i < end * points.side; ++i) body(i);
  });
}

Points sample(const HeightGrid& grid) {
  Points points{grid.cells + 1, grid.side / static_cast<float>(grid.cells), -0.5f * grid.side, {}, {}};
  points.heights.resize(size_t{points.side} * points.side);
  points.covers.resize(points.heights.size());
  for_each_point(points, [&](uint32_t i) {
    const glm::vec3 p = points.position(i);
    points.heights[i] = grid.height({p.x, p.z});
  });
  for_each_point(points, [&](uint32_t i) { points.covers[i] = grid.cover(points.position(i), points.normal(i)); });
  return points;
}

/// The index each point has in the geometry of one kind, for the points its triangles use.
struct Renumbering {
  std::vector<uint32_t> local;   ///< by point
  std::vector<uint32_t> points;  ///< by local index
};

Renumbering renumber(const std::vector<uint32_t>& corners, size_t point_count) {
  constexpr uint32_t unused = ~0u;
  Renumbering result{std::vector<uint32_t>(point_count, unused), {}};
  for (const uint32_t corner : corners) result.local[corner] = 0;
  for (uint32_t i = 0; i < point_count; ++i) {
    if (result.local[i] == unused) continue;
    result.local[i] = static_cast<uint32_t>(result.points.size());
    result.points.push_back(i);
  }
  return result;
}

/// Cut along the diagonal that bends less.
void add_cell(std::vector<uint32_t>& corners, const Points& points, uint32_t a) {
  const uint32_t b = a + 1, c = a + points.side, d = c + 1;
  const auto height = [&](uint32_t i) { return points.heights[i]; };
  if (std::fabs(height(a) - height(d)) < std::fabs(height(b) - height(c))) {
    corners.insert(corners.end(), {a, c, d, a, d, b});
  } else {
    corners.insert(corners.end(), {a, c, b, b, c, d});
  }
}

std::vector<uint32_t> corners_of_kind(const Points& points, size_t kind) {
  std::vector<uint32_t> corners;
  for (uint32_t row = 0; row + 1 < points.side; ++row) {
    for (uint32_t a = row * points.side; a + 1 < (row + 1) * points.side; ++a) {
      if (points.covers[a].kind == kind) add_cell(corners, points, a);
    }
  }
  return corners;
}

void fill_vertex(Geometry& geometry, size_t vertex, const Points& points, uint32_t point) {
  const glm::vec3 position = points.position(point);
  geometry.positions[vertex] = position;
  geometry.normals[vertex] = points.normal(point);
  geometry.colors[vertex] = glm::vec4(points.covers[point].color, 1.0f);
  geometry.uv0[vertex] = {position.x, position.z};
}

void fill(Geometry& geometry, const Points& points, std::vector<uint32_t> corners) {
  const Renumbering renumbering = renumber(corners, points.heights.size());
  const size_t count = renumbering.points.size();
  geometry.positions.resize(count), geometry.normals.resize(count);
  geometry.colors.resize(count), geometry.uv0.resize(count);
  parallel_for(count, 1 << 16, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) fill_vertex(geometry, i, points, renumbering.points[i]);
  });
  for (uint32_t& corner : corners) corner = renumbering.local[corner];
  geometry.indices = std::move(corners);
}

}  // namespace

std::vector<Geometry> make_height_grid(const HeightGrid& grid) {
  const Points points = sample(grid);
  std::vector<Geometry> geometries(grid.materials.size());
  parallel_for(geometries.size(), 1, [&](uint64_t begin, uint64_t end) {
    for (uint64_t kind = begin; kind < end; ++kind) {
      geometries[kind].name = grid.materials[kind].first;
      geometries[kind].material = grid.materials[kind].second;
      fill(geometries[kind], points, corners_of_kind(points, kind));
    }
  });
  std::erase_if(geometries, [](const Geometry& geometry) { return geometry.indices.empty(); });
  return geometries;
}

}  // namespace rayloom::scenes
