// Closed meshes, triangle by triangle: exactly one hit from inside, and how rarely the filters are in doubt.

#include "lane_cases.h"
#include "triangle_cases.h"

#include <rayloom/accel/refined_triangle.h>
#include <rayloom/accel/simd/lanes_scalar.h>
#include <rayloom/accel/triangle.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <vector>

namespace rayloom::accel {
namespace {

using test::Point;
using test::Random;
using test::Triangle;

/// A sphere of latitude rings; 4 * rings * (rings - 1) triangles, closed, with shared vertices bit for bit equal.
std::vector<Triangle> sphere(int rings, float radius, const Point& centre) {
  const auto vertex = [&](int ring, int column) -> Point {
    const double theta = M_PI * ring / rings, phi = M_PI * (column % (2 * rings)) / rings;
    const double r = ring == 0 || ring == rings ? 0 : radius * std::sin(theta);
    return {static_cast<float>(centre[0] + r * std::cos(phi)), static_cast<float>(centre[1] + r * std::sin(phi)),
            static_cast<float>(centre[2] + radius * std::cos(theta))};
  };
  std::vector<Triangle> triangles;
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < 2 * rings; ++column) {
      const Point a = vertex(ring, column), b = vertex(ring + 1, column), c = vertex(ring + 1, column + 1),
                  d = vertex(ring, column + 1);
      if (ring + 1 < rings) triangles.push_back({a, b, c});
      if (ring > 0) triangles.push_back({a, c, d});
    }
  }
  return triangles;
}

PreparedRay prepare(const Ray& ray) {
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  return prepare_ray(ray, box[0], box[1]);
}

int count_hits(const std::vector<Triangle>& mesh, const Ray& ray) {
  const PreparedRay prepared = prepare(ray);
  int hits = 0;
  for (const Triangle& t : mesh)
    hits += intersect_triangle(prepared, t[0].data(), t[1].data(), t[2].data()).has_value();
  return hits;
}

/// A ray from near the centre to a vertex or a point of an edge, its direction off by up to four floats.
Ray aimed_ray(Random& random, const std::vector<Triangle>& mesh, const Point& centre, float radius) {
  const Triangle& triangle = mesh[random.below(static_cast<uint32_t>(mesh.size()))];
  Point origin = centre;
  for (float& value : origin) value += random.uniform(-0.3f, 0.3f) * radius;
  const auto family = random.chance(2) ? test::Family::vertex : test::Family::edge;
  Ray ray = test::ray_towards(origin, test::target_of(random, triangle, family));
  for (float& value : ray.direction) value = random.nudged(value, 4);
  return ray;
}

TEST_CASE("rays from inside a closed mesh hit it exactly once, at every scale and position", "[oracle]") {
  struct Place {
    float radius, offset;
  };
  const Place places[] = {{1, 0},      {1, 1e3f},   {1, 1e5f},      {2, 148376},  {1, 1e6f},
                          {1e-12f, 0}, {1e-18f, 0}, {0x1p-100f, 0}, {0x1p90f, 0}, {1e30f, 0}};
  for (const Place& place : places) {
    const Point centre{place.offset, 0.3f * place.offset, -place.offset};
    const std::vector<Triangle> mesh = sphere(8, place.radius, centre);
    Random random(71);
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
      const Ray ray = aimed_ray(random, mesh, centre, place.radius);
      if (ray.direction[0] == 0 && ray.direction[1] == 0 && ray.direction[2] == 0) continue;
      wrong += count_hits(mesh, ray) != 1;
    }
    INFO("radius " << place.radius << " at " << place.offset);
    CHECK(wrong == 0);
  }
}

TEST_CASE("rays along the grid through edges and vertices of a closed box hit it once", "[oracle]") {
  std::vector<Triangle> mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {0.0f, 4.0f}) {
      const auto corner = [&](int i, int j) {
        Point p;
        p[axis] = side;
        p[(axis + 1) % 3] = static_cast<float>(i), p[(axis + 2) % 3] = static_cast<float>(j);
        return p;
      };
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          mesh.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
          mesh.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
        }
      }
    }
  }
  Random random(73);
  for (int i = 0; i < 5000; ++i) {
    const auto inside = [&] { return static_cast<float>(1 + random.below(5)) / 2 + 0.5f; };
    Ray ray = test::ray_towards({inside(), inside(), inside()}, {0, 0, 0});
    const uint32_t pattern = 1 + random.below(7);
    for (int k = 0; k < 3; ++k) ray.direction[k] = (pattern >> k & 1) == 0 ? 0.0f : random.chance(2) ? 1.0f : -1.0f;
    REQUIRE(count_hits(mesh, ray) == 1);
  }
}

/// Lanes that float, then double, then double-double could not decide or round.
struct Doubt {
  uint64_t lanes = 0, in_float = 0, in_double = 0, in_double_double = 0;
};

TriangleEffort effort_of(const PreparedRay& ray, const Triangle& triangle) {
  TriangleEffort effort;
  observed_hit(ray, {{triangle[0].data(), triangle[1].data(), triangle[2].data()}},
               std::numeric_limits<float>::infinity(), false, effort);
  return effort;
}

void count_doubt(const PreparedRay& ray, const std::vector<Triangle>& mesh, size_t first, Doubt& doubt) {
  const size_t count = std::min<size_t>(8, mesh.size() - first);
  PlainTriangleLeaf leaf = test::plain_leaf(static_cast<uint32_t>(count));
  for (size_t lane = 0; lane < 8; ++lane) {
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (int k = 0; k < 3; ++k) leaf.vertex[k][vertex][lane] = mesh[first + lane % count][vertex][k];
    }
  }
  const LeafMasks masks = scalar::test_triangles(scalar::TriangleLanes(ray), leaf, DepthInterval(ray, ray.t_max));
  doubt.lanes += count;
  for (size_t lane = 0; lane < count; ++lane) {
    if ((masks.possible & ~masks.certain) >> lane & 1) {
      ++doubt.in_float;
      const TriangleEffort effort = effort_of(ray, mesh[first + lane]);
      doubt.in_double += effort.refined;
      doubt.in_double_double += effort.integer_signs || effort.integer_quotients > 0;
    }
  }
}

TEST_CASE("random rays on a sphere of 20,000 triangles leave few lanes undecided", "[unit]") {
  const std::vector<Triangle> mesh = sphere(72, 1, {0, 0, 0});
  REQUIRE(mesh.size() == 20448);
  Random random(79);
  Doubt doubt;
  for (int i = 0; i < 600; ++i) {
    const Ray ray = test::ray_towards(test::random_point(random, 2), test::random_point(random, 1));
    const PreparedRay prepared = prepare(ray);
    for (size_t first = 0; first < mesh.size(); first += 8) count_doubt(prepared, mesh, first, doubt);
  }
  const double lanes = static_cast<double>(doubt.lanes);
  std::printf("%.3g lanes: undecided in float %.3g, in double %.3g\n", lanes,
              static_cast<double>(doubt.in_float) / lanes, static_cast<double>(doubt.in_double) / lanes);
  CHECK(static_cast<double>(doubt.in_float) < 1e-4 * lanes);
  CHECK(static_cast<double>(doubt.in_double) < 1e-6 * lanes);
  CHECK(doubt.in_double_double == 0);
}

}  // namespace
}  // namespace rayloom::accel
