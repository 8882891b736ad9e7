#include <rayloom/base/error.h>
#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>
#include <rayloom/scenes/summary.h>

#include <catch2/catch.hpp>
#include <cmath>

using namespace rayloom;
using namespace rayloom::scenes;

namespace {

template <typename V>
void add_vectors(Hash64& hash, const std::vector<V>& vectors) {
  for (const V& v : vectors) {
    for (int i = 0; i < v.length(); ++i) hash.add(v[i]);
  }
}

uint64_t hash_of(const Scene& scene) {
  Hash64 hash;
  for (const Mesh& mesh : scene.meshes) {
    for (const Geometry& g : mesh.geometries) {
      hash.add(g.indices).add(g.material);
      add_vectors(hash, g.positions), add_vectors(hash, g.normals), add_vectors(hash, g.uv0);
    }
    for (const SphereSet& set : mesh.sphere_sets) {
      for (const Sphere& s : set.spheres) hash.add(s.center.x).add(s.center.y).add(s.center.z).add(s.radius);
    }
  }
  for (const Instance& instance : scene.instances) hash.add(instance.transform).add(instance.mesh);
  for (const Material& m : scene.materials) hash.add(m.base_color.x).add(m.roughness).add(m.emissive.x);
  for (const auto& image : scene.images) hash.add(image->pixels().bytes);
  return hash.value();
}

/// Finite positions, valid indices, unit normals on the side the winding faces.
void check_geometry(const Geometry& g, bool cloth) {
  REQUIRE(g.normals.size() == g.positions.size());
  REQUIRE(g.uv0.size() == g.positions.size());
  size_t against = 0, bad = 0;
  for (size_t i = 0; i < g.indices.size(); i += 3) {
    const uint32_t* v = &g.indices[i];
    if (v[0] >= g.positions.size() || v[1] >= g.positions.size() || v[2] >= g.positions.size()) FAIL("index");
    const glm::vec3 a = g.positions[v[0]];
    const glm::vec3 face = glm::cross(g.positions[v[1]] - a, g.positions[v[2]] - a);
    against += glm::dot(face, g.normals[v[0]] + g.normals[v[1]] + g.normals[v[2]]) < 0;
  }
  for (const glm::vec3& n : g.normals) bad += !(std::fabs(glm::dot(n, n) - 1) < 1e-5f);
  for (const glm::vec3& p : g.positions) bad += !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z);
  INFO(g.name);
  CHECK(bad == 0);
  CHECK(against <= (cloth ? g.triangle_count() / 100 : 0));
}

void check_scene(const Scene& scene) {
  REQUIRE_FALSE(scene.cameras.empty());
  REQUIRE_FALSE(scene.materials.empty());
  for (const Instance& instance : scene.instances) REQUIRE(instance.mesh < scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    CHECK(mesh.geometries.empty() != mesh.sphere_sets.empty());
    for (const Geometry& g : mesh.geometries) {
      REQUIRE(g.material < scene.materials.size());
      check_geometry(g, g.name == "drape");
    }
    for (const SphereSet& set : mesh.sphere_sets) REQUIRE(set.material < scene.materials.size());
  }
}

/// The solid a box or room encloses, signed: positive when faces look outwards.
double signed_volume(const Geometry& g) {
  double volume = 0;
  for (size_t i = 0; i < g.indices.size(); i += 3) {
    const glm::dvec3 a(g.positions[g.indices[i]]), b(g.positions[g.indices[i + 1]]), c(g.positions[g.indices[i + 2]]);
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  return volume;
}

}  // namespace

TEST_CASE("every procedural scene is well formed") {
  for (const char* name : {"triangle", "cornell", "spheres", "atrium"}) check_scene(load_scene(name));
}

TEST_CASE("the same bits for any thread count") {
  for (const char* name : {"cornell", "spheres", "atrium"}) {
    uint64_t hashes[3];
    const unsigned threads[3] = {1, 2, 5};
    for (int i = 0; i < 3; ++i) {
      const ThreadLimit limit(threads[i]);
      hashes[i] = hash_of(load_scene(name));
    }
    INFO(name);
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
  }
}

TEST_CASE("cornell: blocks are closed and face outwards, the room faces inwards") {
  const Scene scene = load_scene("cornell");
  CHECK(signed_volume(scene.meshes[1].geometries[0]) == Approx(0.6 * 0.6 * 0.6));
  const glm::vec3 inside(0, 1, 0);
  for (const Geometry& wall : scene.meshes[0].geometries)
    CHECK(glm::dot(wall.normals[0], inside - wall.positions[0]) > 0);
  CHECK(scene.meshes[2].geometries[0].normals[0] == glm::vec3(0, -1, 0));
  CHECK(scene.materials[scene.meshes[2].geometries[0].material].emits());
}

TEST_CASE("spheres: 488 of them, none of the small ones inside a large one") {
  const Scene scene = load_scene("spheres");
  CHECK(summarize(scene).spheres == 488);
  std::vector<Sphere> large, small;
  for (const SphereSet& set : scene.meshes[0].sphere_sets) {
    for (const Sphere& sphere : set.spheres) (sphere.radius < 0.5f ? small : large).push_back(sphere);
  }
  REQUIRE(large.size() == 4);
  REQUIRE(small.size() == 484);
  for (const Sphere& b : large) {
    for (const Sphere& s : small) {
      const glm::dvec3 apart = glm::dvec3(s.center) - glm::dvec3(b.center);
      CHECK(std::sqrt(glm::dot(apart, apart)) > static_cast<double>(b.radius) + static_cast<double>(s.radius) - 1e-3);
    }
  }
}

TEST_CASE("atrium: at least 400,000 triangles, masked foliage, a camera inside") {
  const uint64_t decoded_before = images_decoded();
  const Scene scene = load_scene("atrium");
  const SceneSummary summary = summarize(scene);
  CHECK(summary.triangles >= 400000);
  CHECK(summary.instanced_triangles >= 1000000);
  CHECK(summary.masked_materials == 1);
  CHECK(summary.directional_lights == 1);
  for (const SceneCamera& camera : scene.cameras) {
    CHECK(glm::all(glm::lessThan(summary.bounds.min, camera.position)));
    CHECK(glm::all(glm::lessThan(camera.position, summary.bounds.max)));
  }
  size_t clear = 0, solid = 0;
  const Pixels& leaf = scene.images.at(3)->pixels();
  for (size_t i = 3; i < leaf.bytes.size(); i += 4) (leaf.bytes[i] == 0 ? clear : solid) += 1;
  CHECK(clear > leaf.bytes.size() / 4 / 10);
  CHECK(solid > leaf.bytes.size() / 4 / 10);
  CHECK(images_decoded() == decoded_before);
}

TEST_CASE("parameters are checked") {
  CHECK(summarize(load_scene("atrium:detail=2")).triangles > 3 * summarize(load_scene("atrium")).triangles);
  CHECK_THROWS_WITH(load_scene("atrium:detail=9"), "atrium:detail=9: detail: 9 must be at least 1 and at most 4");
  CHECK_THROWS_WITH(load_scene("atrium:size=1"), Catch::Contains("size: no such parameter; atrium has detail"));
  CHECK_THROWS_WITH(load_scene("cornell:x"), Catch::Contains("a parameter must be key=whole number"));
  CHECK_THROWS_AS(load_scene("cornell:x=1"), InputError);
  CHECK(load_scene("cornell").name == "cornell");
}
