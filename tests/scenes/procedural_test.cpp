#include "procedural_checks.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/procedural/registry.h>
#include <rayloom/scenes/summary.h>

#include <catch2/catch.hpp>
#include <cmath>

using namespace rayloom;
using namespace rayloom::scenes;

TEST_CASE("every procedural scene is well formed") {
  for (const char* name : {"triangle", "cornell", "spheres", "atrium"}) check_scene(load_scene(name), {"drape"});
}

TEST_CASE("the same bits for any thread count") {
  for (const char* name : {"cornell", "spheres", "atrium"}) check_thread_counts(name);
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

TEST_CASE("the help names every procedural scene, and every parameter there is") {
  const std::string names = procedural_scene_names() + ", ", help = procedural_scene_help();
  for (size_t begin = 0; begin < names.size();) {
    const size_t end = names.find(", ", begin);
    CHECK_THAT(help, Catch::Contains("  " + names.substr(begin, end - begin) + " "));
    begin = end + 2;
  }
  CHECK_THAT(help, Catch::Contains("resolution=8..4096 (1500)"));
}
