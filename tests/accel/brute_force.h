#pragma once

// The oracle O1: every primitive, in order of its name, against the exact triangle test; no box, no tree, no SIMD.

#include "structures.h"

#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/triangle.h>
#include <rayloom/accel/triangle_input.h>

namespace rayloom::accel::test {

/// A triangle with its name, in the object space of its instance.
struct NamedTriangle {
  uint32_t geometry, primitive;
  InputTriangle corners;
};

/// All triangles whose coordinates are finite.
inline std::vector<NamedTriangle> all_triangles(const std::vector<TriangleGeometry>& geometries) {
  std::vector<NamedTriangle> triangles;
  for (uint32_t g = 0; g < geometries.size(); ++g)
    for (uint32_t i = 0; i < geometries[g].triangle_count; ++i)
      triangles.push_back({g, i, read_triangle(geometries[g], i)});
  return triangles;
}

/// A ray valid by TR-17 and TR-18 against any bounds.
inline PreparedRay prepare_alone(const Ray& ray) {
  const float low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  return prepare_ray(ray, low, high);
}

/// Every hit with t_min < t < t_max, facing left aside, in order of the names.
inline std::vector<Hit> all_hits(const std::vector<NamedTriangle>& triangles, const Ray& ray, uint32_t instance = 0) {
  std::vector<Hit> hits;
  const PreparedRay prepared = prepare_alone(ray);
  if (!prepared.valid) return hits;
  for (const NamedTriangle& triangle : triangles) {
    const auto& v = triangle.corners.vertex;
    const auto hit = intersect_triangle(prepared, v[0], v[1], v[2], ray.t_max);
    if (hit && hit->t < ray.t_max)
      hits.push_back({hit->t, hit->u, hit->v, instance, triangle.geometry, triangle.primitive, hit->hit_kind(),
                      HitType::triangle});
  }
  return hits;
}

/// The first of the smallest t, which is the one of the smallest name; no hit as trace() reports it.
inline Hit closest_of(const std::vector<Hit>& hits, const Ray& ray) {
  Hit closest;
  closest.t = ray.t_max;
  for (const Hit& hit : hits)
    if (hit.t < closest.t) closest = hit;
  return closest;
}

}  // namespace rayloom::accel::test
