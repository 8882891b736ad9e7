#include "procedural_checks.h"

#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <iterator>

namespace rayloom::scenes {
namespace {

template <typename V>
void add_vectors(Hash64& hash, const std::vector<V>& vectors) {
  for (const V& v : vectors) {
    for (int i = 0; i < v.length(); ++i) hash.add(v[i]);
  }
}

bool finite(glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

struct Faults {
  size_t index = 0, against = 0, degenerate = 0, position = 0, normal = 0;
};

void check_triangle(const Geometry& g, const uint32_t* v, Faults& faults) {
  if (std::max({v[0], v[1], v[2]}) >= g.positions.size()) {
    ++faults.index;
    return;
  }
  const glm::dvec3 a(g.positions[v[0]]), b(g.positions[v[1]]), c(g.positions[v[2]]);
  const glm::dvec3 face = glm::cross(b - a, c - a);
  faults.degenerate += !(glm::dot(face, face) > 0);
  faults.against += glm::dot(face, glm::dvec3(g.normals[v[0]] + g.normals[v[1]] + g.normals[v[2]])) < 0;
}

void check_geometry(const Geometry& g, bool may_fold) {
  INFO(g.name);
  REQUIRE(g.normals.size() == g.positions.size());
  REQUIRE(g.uv0.size() == g.positions.size());
  REQUIRE((g.colors.empty() || g.colors.size() == g.positions.size()));
  REQUIRE(g.indices.size() % 3 == 0);
  REQUIRE_FALSE(g.indices.empty());
  Faults faults;
  for (size_t i = 0; i < g.indices.size(); i += 3) check_triangle(g, &g.indices[i], faults);
  for (const glm::vec3& n : g.normals) faults.normal += !(std::fabs(glm::dot(n, n) - 1) < 1e-5f);
  for (const glm::vec3& p : g.positions) faults.position += !finite(p);
  CHECK(faults.index == 0);
  CHECK(faults.degenerate == 0);
  CHECK(faults.position == 0);
  CHECK(faults.normal == 0);
  CHECK(faults.against <= (may_fold ? g.triangle_count() / 100 : 0));
}

using Point = std::array<float, 3>;
using Edge = std::pair<Point, Point>;

std::vector<Edge> sorted_edges(const Geometry& g, bool reversed) {
  const auto point = [&](uint32_t vertex) {
    const glm::vec3 p = g.positions[vertex] + 0.0f;  // -0 and 0 are one place
    return Point{p.x, p.y, p.z};
  };
  std::vector<Edge> edges;
  for (size_t i = 0; i < g.indices.size(); ++i) {
    const Point from = point(g.indices[i]), to = point(g.indices[i % 3 == 2 ? i - 2 : i + 1]);
    edges.push_back(reversed ? Edge{to, from} : Edge{from, to});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

uint64_t hash_of(const Scene& scene) {
  Hash64 hash;
  for (const Mesh& mesh : scene.meshes) {
    for (const Geometry& g : mesh.geometries) {
      hash.add(g.indices).add(g.material);
      add_vectors(hash, g.positions), add_vectors(hash, g.normals), add_vectors(hash, g.uv0);
      add_vectors(hash, g.colors);
    }
    for (const SphereSet& set : mesh.sphere_sets) {
      for (const Sphere& s : set.spheres) hash.add(s.center.x).add(s.center.y).add(s.center.z).add(s.radius);
    }
  }
  for (const Instance& instance : scene.instances) hash.add(instance.transform).add(instance.mesh);
  for (const Material& m : scene.materials) hash.add(m.base_color.x).add(m.roughness).add(m.emissive.x);
  for (const auto& image : scene.images) hash.add(image->pixels().bytes);
  for (const SceneCamera& c : scene.cameras) hash.add(c.position.x).add(c.position.y).add(c.backward.x);
  return hash.value();
}

void check_scene(const Scene& scene, const std::set<std::string>& may_fold) {
  INFO(scene.name);
  REQUIRE_FALSE(scene.cameras.empty());
  REQUIRE_FALSE(scene.materials.empty());
  size_t bad_instances = 0;
  for (const Instance& instance : scene.instances) {
    bad_instances += instance.mesh >= scene.meshes.size();
    for (const float entry : instance.transform) bad_instances += !std::isfinite(entry);
  }
  CHECK(bad_instances == 0);
  for (const Mesh& mesh : scene.meshes) {
    CHECK(mesh.geometries.empty() != mesh.sphere_sets.empty());
    for (const Geometry& g : mesh.geometries) {
      REQUIRE(g.material < scene.materials.size());
      check_geometry(g, may_fold.contains(g.name));
    }
    for (const SphereSet& set : mesh.sphere_sets) REQUIRE(set.material < scene.materials.size());
  }
}

double signed_volume(const Geometry& g) {
  double volume = 0;
  for (size_t i = 0; i < g.indices.size(); i += 3) {
    const glm::dvec3 a(g.positions[g.indices[i]]), b(g.positions[g.indices[i + 1]]), c(g.positions[g.indices[i + 2]]);
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  return volume;
}

size_t open_edges(const Geometry& g) {
  const auto edges = sorted_edges(g, false), reversed = sorted_edges(g, true);
  std::vector<Edge> open;
  std::set_symmetric_difference(edges.begin(), edges.end(), reversed.begin(), reversed.end(), std::back_inserter(open));
  return open.size() / 2;
}

size_t repeated_edges(const Geometry& g) {
  const auto edges = sorted_edges(g, false);
  size_t count = 0;
  for (size_t i = 1; i < edges.size(); ++i) count += edges[i] == edges[i - 1];
  return count;
}

void check_thread_counts(const std::string& name) {
  uint64_t expected = 0;
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    const uint64_t hash = hash_of(load_scene(name));
    if (threads == 1) expected = hash;
    INFO(name << " with " << threads << " threads");
    CHECK(hash == expected);
  }
}

}  // namespace rayloom::scenes
