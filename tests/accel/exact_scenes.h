#pragma once

// Small scenes that are hard for every part of a tracer at once, each with rays aimed at what is hard in it.

#include "meshes.h"
#include "random.h"
#include "structures.h"

#include <functional>
#include <string>
#include <vector>

namespace rayloom::accel::test {

struct ExactScene {
  std::string name;
  std::vector<Mesh> geometries;
  std::vector<Transform3x4> instances;  ///< each of all geometries; empty: the bottom level alone
  float reach = 1;                      ///< how far away rays start
  bool axis_rays = false;
};

inline Point point_in(Random& random, float reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

inline float whole(Random& random, uint32_t most) {
  return static_cast<float>(static_cast<int>(random.below(2 * most + 1)) - static_cast<int>(most));
}

inline float step_up(float value, uint32_t steps) {
  for (uint32_t i = 0; i < steps; ++i) value = std::nextafter(value, std::numeric_limits<float>::max());
  return value;
}

/// Slivers that lie in shared planes exactly: whole multiples of two whole vectors.
inline ExactScene slivers_in_planes(Random& random) {
  Mesh mesh;
  for (int plane = 0; plane < 3; ++plane) {
    Point base, along, across;
    for (int k = 0; k < 3; ++k) base[k] = whole(random, 8), along[k] = whole(random, 3), across[k] = whole(random, 3);
    const auto at = [&](float a, float b) {
      return Point{base[0] + a * along[0] + b * across[0], base[1] + a * along[1] + b * across[1],
                   base[2] + a * along[2] + b * across[2]};
    };
    for (int i = 0; i < 10; ++i) {
      const float row = whole(random, 2);
      mesh.add_triangle(at(whole(random, 100), row), at(whole(random, 100), row), at(whole(random, 100), row + 1));
    }
  }
  return {"slivers in shared planes", {mesh}, {}, 40};
}

/// Needles around one apex whose outer corners are a few floats apart, closed to a fan.
inline ExactScene needle_fan(Random& random) {
  Mesh mesh;
  const Point centre = point_in(random, 1);
  const uint32_t apex = mesh.add(centre);
  Point rim = point_in(random, 1);
  const uint32_t needles = 8 + random.below(24);
  for (uint32_t i = 0; i < needles; ++i) {
    mesh.add(rim);
    for (float& x : rim) x = random.nudged(x, 3);
  }
  for (uint32_t i = 1; i <= needles; ++i) mesh.triangles.push_back({apex, i, i % needles + 1});
  return {"needle fan", {mesh}, {}, 2};
}

/// Layers one float above the other, some corners off by one more.
inline ExactScene layers(Random& random) {
  Mesh low, high;
  const float height = random.scaled(-4, 4);
  const int axis = static_cast<int>(random.below(3));
  for (int i = 0; i < 30; ++i) {
    Point p[3];
    for (Point& corner : p) {
      corner = point_in(random, 2);
      corner[axis] = step_up(height, random.below(4));
    }
    (i % 2 ? low : high).add_triangle(p[0], p[1], p[2]);
  }
  return {"layers one float apart", {low, high}, {}, 4};
}

/// The same triangles again, turned and mirrored, under other names, and triangles without area among them.
inline ExactScene duplicates(Random& random) {
  std::vector<Mesh> meshes(3);
  for (int i = 0; i < 8; ++i) {
    std::array<Point, 3> p = {point_in(random, 1), point_in(random, 1), point_in(random, 1)};
    for (int copy = 0; copy < 4; ++copy) {
      std::rotate(p.begin(), p.begin() + random.below(3), p.end());
      if (random.chance(2)) std::swap(p[0], p[1]);
      meshes[random.below(3)].add_triangle(p[0], p[1], p[2]);
    }
    const Point middle = {0.5f * (p[0][0] + p[1][0]), 0.5f * (p[0][1] + p[1][1]), 0.5f * (p[0][2] + p[1][2])};
    meshes[random.below(3)].add_triangle(p[0], random.chance(2) ? p[0] : middle, p[1]);
  }
  return {"duplicates and triangles without area", meshes, {}, 3};
}

/// Triangles across one line, at distances and of sizes from 1e-30 to 1e30.
inline ExactScene mixed_scales(Random& random) {
  Mesh mesh;
  const Point along = point_in(random, 1);
  for (int i = 0; i < 30; ++i) {
    const float scale = std::ldexp(random.uniform(1, 2), 2 * static_cast<int>(random.below(100)) - 100);
    Point p[3];
    for (Point& corner : p) {
      corner = point_in(random, 0.5f);
      for (int k = 0; k < 3; ++k) corner[k] = (along[k] + corner[k]) * scale;
    }
    mesh.add_triangle(p[0], p[1], p[2]);
  }
  return {"scales from 1e-30 to 1e30", {mesh}, {}, 0};
}

/// Corners on a lattice of whole numbers times `unit`, and rays along the axes through them.
inline ExactScene lattice(Random& random, float unit) {
  std::vector<Mesh> meshes(2);
  const auto corner = [&] { return Point{whole(random, 3) * unit, whole(random, 3) * unit, whole(random, 3) * unit}; };
  for (int i = 0; i < 40; ++i) {
    const Point a = corner(), b = corner(), c = corner();
    meshes[random.below(2)].add_triangle(a, b, c);
  }
  return {"lattice", meshes, {}, 6 * unit, true};
}

/// A strip folded so finely that rays along it see every triangle from its edge.
inline ExactScene edge_on(Random& random) {
  Mesh mesh;
  for (int i = 0; i <= 30; ++i) {
    const float x = static_cast<float>(i) / 8;
    mesh.add({x, random.chance(2) ? 0.0f : random.scaled(-149, -20), i % 2 ? 1.0f : -1.0f});
  }
  for (uint32_t i = 0; i < 29; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  return {"strip seen from its edge", {mesh}, {}, 4, true};
}

/// A transform of one of these kinds: without rounding, mirrored, sheared, with columns that almost agree, flattened to
/// a thousandth of a float.
inline Transform3x4 hard_transform(Random& random) {
  Transform3x4 m = identity_transform;
  const uint32_t kind = random.below(5);
  if (kind == 0) {
    const uint32_t turn = random.below(3);
    m.fill(0);
    for (uint32_t row = 0; row < 3; ++row)
      m[4 * row + (row + turn) % 3] =
          std::ldexp(random.chance(2) ? 1.0f : -1.0f, static_cast<int>(random.below(7)) - 3);
  } else {
    for (int i = 0; i < 12; ++i)
      if (i % 4 != 3) m[i] = random.uniform(-1, 1);
    const float almost = kind == 3 ? std::ldexp(1.0f, -static_cast<int>(random.below(23))) : 1;
    if (kind >= 2)
      for (int row = 0; row < 3; ++row) m[4 * row + 1] = m[4 * row] + almost * m[4 * row + 1];
    if (kind == 4)
      for (int k = 0; k < 3; ++k) m[k] *= 0x1p-30f;
  }
  for (int row = 0; row < 3; ++row) m[4 * row + 3] = random.chance(2) ? whole(random, 4) : random.uniform(-4, 4);
  return m;
}

/// The same scene `factor` times as large, a power of two.
inline ExactScene scaled(ExactScene scene, float factor) {
  for (Mesh& mesh : scene.geometries) mesh = moved(mesh, factor, 0);
  for (Transform3x4& m : scene.instances)
    for (int row = 0; row < 3; ++row) m[4 * row + 3] *= factor;
  scene.reach *= factor;
  return scene;
}

using SceneMaker = ExactScene (*)(Random&);

inline ExactScene unit_lattice(Random& random) { return lattice(random, 1); }
inline ExactScene tiny_lattice(Random& random) { return lattice(random, 0x1p-149f); }
inline ExactScene huge_lattice(Random& random) { return lattice(random, 0x1p120f); }

inline ExactScene instanced(Random& random) {
  const SceneMaker makers[] = {slivers_in_planes, needle_fan, layers, duplicates, unit_lattice};
  ExactScene scene = makers[random.below(5)](random);
  for (uint32_t i = 1 + random.below(4); i > 0; --i) scene.instances.push_back(hard_transform(random));
  if (random.chance(2)) scene.instances.push_back(scene.instances.front());  // the same once more
  scene.name += ", in instances";
  return scene;
}

inline constexpr SceneMaker all_exact_scenes[] = {slivers_in_planes, needle_fan,   layers,       duplicates,
                                                  mixed_scales,      unit_lattice, tiny_lattice, huge_lattice,
                                                  edge_on,           instanced};

inline Point through(const Transform3x4& m, const Point& p) {
  Point out;
  for (int row = 0; row < 3; ++row)
    out[row] = m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
  return out;
}

/// A corner, a point of an edge, or one inside a triangle, as nearly as floats can say it.
inline Point target_in(Random& random, const ExactScene& scene) {
  const Mesh& mesh = scene.geometries[random.below(static_cast<uint32_t>(scene.geometries.size()))];
  if (mesh.triangles.empty()) return {0, 0, 0};
  const auto& t = mesh.triangles[random.below(static_cast<uint32_t>(mesh.triangles.size()))];
  const uint32_t corner = random.below(3), kind = random.below(3);
  Point p = mesh.vertices[t[corner]];
  for (uint32_t other = 1; other <= kind; ++other) {
    const Point& q = mesh.vertices[t[(corner + other) % 3]];
    const float s = random.chance(2) ? 0.5f : random.uniform(0, 1);
    for (int k = 0; k < 3; ++k) p[k] += s * (q[k] - p[k]);
  }
  if (scene.instances.empty()) return p;
  return through(scene.instances[random.below(static_cast<uint32_t>(scene.instances.size()))], p);
}

/// A ray at something hard.
inline Ray hard_ray(Random& random, const ExactScene& scene) {
  const Point to = target_in(random, scene);
  Point from = random.chance(3) ? target_in(random, scene) : point_in(random, scene.reach);
  Ray ray = ray_between(from, to);
  if (scene.axis_rays && random.chance(2)) {
    const uint32_t axis = random.below(3);
    for (uint32_t k = 0; k < 3; ++k) {
      if (k != axis) ray.origin[k] = to[k];
      ray.direction[k] = k != axis ? (random.chance(2) ? 0.0f : -0.0f) : random.chance(2) ? 1.0f : -1.0f;
    }
  } else if (random.chance(2)) {
    for (float& x : ray.direction) x = random.nudged(x, 3);
  }
  const float length = random.chance(4) ? std::ldexp(1.0f, static_cast<int>(random.below(48)) - 24) : 1;
  for (float& x : ray.direction) x *= length;
  return ray;
}

inline bool is_traceable(const Ray& ray) {
  bool moves = false;
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(ray.origin[k]) || !std::isfinite(ray.direction[k])) return false;
    moves |= ray.direction[k] != 0;
  }
  return moves;
}

/// Half of them in bundles of 16 that share an origin and go almost the same way, as packets do.
inline std::vector<Ray> hard_rays(Random& random, const ExactScene& scene, size_t count) {
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Ray ray = hard_ray(random, scene);
    if (!is_traceable(ray)) continue;
    const bool bundle = rays.size() % 16 == 0 && random.chance(2);
    for (int i = 0; i < (bundle ? 16 : 1); ++i) {
      rays.push_back(ray);
      if (bundle)
        for (float& x : rays.back().direction)
          x = random.chance(8) ? x * random.uniform(0.99f, 1.01f) : random.nudged(x, 2);
    }
  }
  return rays;
}

}  // namespace rayloom::accel::test
