#pragma once

// Meshes for the accel tests, all made here. Closed ones are consistently indexed: a shared vertex is one vertex.

#include "random.h"

#include <rayloom/accel/build_input.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace rayloom::accel::test {

using Point = std::array<float, 3>;

struct Mesh {
  std::vector<Point> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;

  TriangleGeometry geometry(uint32_t flags = geometry_flag::opaque) const {
    TriangleGeometry g;
    g.vertices = reinterpret_cast<const std::byte*>(vertices.data());
    g.vertex_count = static_cast<uint32_t>(vertices.size());
    g.indices = reinterpret_cast<const std::byte*>(triangles.data());
    g.index_format = IndexFormat::uint32;
    g.triangle_count = static_cast<uint32_t>(triangles.size());
    g.flags = flags;
    return g;
  }

  uint32_t add(const Point& p) {
    vertices.push_back(p);
    return static_cast<uint32_t>(vertices.size() - 1);
  }
  void add_triangle(const Point& a, const Point& b, const Point& c) {
    const uint32_t i = add(a);
    add(b);
    add(c);
    triangles.push_back({i, i + 1, i + 2});
  }
};

/// Long thin triangles in [-2, 2]^3, at one end `width` by twice `height` wide.
inline Mesh needles(uint32_t count, float width, float height, Random& random) {
  Mesh mesh;
  for (uint32_t i = 0; i < count; ++i) {
    const Point a = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const Point b = {a[0] + random.uniform(-1, 1), a[1] + random.uniform(-1, 1), a[2] + random.uniform(-0.1f, 0.1f)};
    mesh.add_triangle(a, b, {b[0] + width, b[1] + random.uniform(-height, height), b[2]});
  }
  return mesh;
}

/// v * scale + offset, in float as a user would.
inline Mesh moved(Mesh mesh, float scale, float offset) {
  for (Point& p : mesh.vertices)
    for (float& x : p) x = x * scale + offset;
  return mesh;
}

/// Each triangle into four, new vertices shared; `place` puts a new vertex onto the surface.
template <class Place>
Mesh subdivided(const Mesh& mesh, const Place& place) {
  Mesh fine;
  fine.vertices = mesh.vertices;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), 0);
    if (is_new) {
      Point p;
      for (int k = 0; k < 3; ++k) p[k] = 0.5f * (mesh.vertices[a][k] + mesh.vertices[b][k]);
      it->second = fine.add(place(p));
    }
    return it->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

inline Point normalised(const Point& p) {
  const float length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  return {p[0] / length, p[1] / length, p[2] / length};
}

inline Mesh octahedron() {
  Mesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

inline Mesh icosahedron() {
  const float a = 1, b = 1.618034f;
  Mesh mesh;
  for (const Point& p : {Point{-a, b, 0},
                         {a, b, 0},
                         {-a, -b, 0},
                         {a, -b, 0},
                         {0, -a, b},
                         {0, a, b},
                         {0, -a, -b},
                         {0, a, -b},
                         {b, 0, -a},
                         {b, 0, a},
                         {-b, 0, -a},
                         {-b, 0, a}})
    mesh.add(normalised(p));
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return mesh;
}

inline Mesh icosphere(int levels) {
  Mesh mesh = icosahedron();
  for (int i = 0; i < levels; ++i) mesh = subdivided(mesh, normalised);
  return mesh;
}

/// A sphere with waves of a fixed pattern on it; star-shaped around the origin.
inline Mesh bumpy_sphere(int levels) {
  Mesh mesh = icosphere(levels);
  for (Point& p : mesh.vertices) {
    const float bump = 1 + 0.2f * (p[0] * p[1] * 3 - p[2] * p[2] + p[0] * p[2] * 2);
    for (float& x : p) x *= bump;
  }
  return mesh;
}

/// The cube [-1, 1]^3 with flat sides of many triangles.
inline Mesh cube(int levels) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.add({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (int i = 0; i < levels; ++i) mesh = subdivided(mesh, [](const Point& p) { return p; });
  return mesh;
}

/// Rings of a ring; the centre of the tube lies at distance 1 from the axis.
inline Mesh torus(uint32_t rings, uint32_t sides, float tube) {
  Mesh mesh;
  const auto angle = [](uint32_t i, uint32_t n) { return 6.2831853f * static_cast<float>(i) / static_cast<float>(n); };
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t j = 0; j < sides; ++j) {
      const float r = 1 + tube * std::cos(angle(j, sides));
      mesh.add({r * std::cos(angle(i, rings)), r * std::sin(angle(i, rings)), tube * std::sin(angle(j, sides))});
    }
  const auto at = [&](uint32_t i, uint32_t j) { return (i % rings) * sides + j % sides; };
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t j = 0; j < sides; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// An integer grid of unit squares in the plane z = `z`, two triangles each, corners at 0..size.
inline Mesh grid(uint32_t size, float z) {
  Mesh mesh;
  for (uint32_t y = 0; y <= size; ++y)
    for (uint32_t x = 0; x <= size; ++x) mesh.add({static_cast<float>(x), static_cast<float>(y), z});
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x) {
      const uint32_t i = y * (size + 1) + x;
      mesh.triangles.push_back({i, i + 1, i + size + 2});
      mesh.triangles.push_back({i, i + size + 2, i + size + 1});
    }
  return mesh;
}

}  // namespace rayloom::accel::test
