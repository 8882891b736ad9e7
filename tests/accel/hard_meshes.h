#pragma once

// Meshes that builders have trouble with, for tests and the numerics laboratory.

#include "meshes.h"
#include "random.h"

namespace rayloom::accel::test {

/// Triangles of all sizes, many small ones beside few large: what spatial splits and reinsertion are for.
inline Mesh mixture(size_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const float size = std::ldexp(1.0f, -static_cast<int>(random.below(7)));
    const auto any = [&] { return random.uniform(-1, 1); };
    const Point a{any(), any(), any()};
    const auto near = [&](float reach) {
      return Point{a[0] + reach * any(), a[1] + reach * any(), a[2] + reach * any()};
    };
    const Point b = near(size), c = near(0.3f * size);
    mesh.add_triangle(a, b, c);
  }
  return mesh;
}

/// One triangle `count` times, over the same vertices.
inline Mesh copies(size_t count) {
  Mesh mesh;
  for (const Point& p : {Point{-1, -1, 1}, {1, -1, 1}, {0, 2, 1}}) mesh.add(p);
  mesh.triangles.assign(count, {0, 1, 2});
  return mesh;
}

/// Triangles around the z axis whose centres all agree.
inline Mesh concentric(size_t count) {
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const float r = 1 + static_cast<float>(i) / static_cast<float>(count);
    mesh.add_triangle({-r, -r, 1}, {r, -r, 1}, {0, r, 1});
  }
  return mesh;
}

/// Layers at 2^-i: every split by position peels a few off.
inline Mesh exponential(int levels, int per_level, bool both_sides) {
  Mesh mesh;
  for (int i = 0; i < levels; ++i)
    for (int k = 0; k < per_level; ++k) {
      const float z = std::ldexp(1.0f + 0.001f * static_cast<float>(k), -i) * (both_sides && k % 2 ? -1.0f : 1.0f);
      mesh.add_triangle({-z, -z, z}, {z, -z, z}, {0, z, z});
    }
  return mesh;
}

}  // namespace rayloom::accel::test
