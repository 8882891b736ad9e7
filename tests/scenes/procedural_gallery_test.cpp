#include "procedural_checks.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/procedural/isosurface.h>
#include <rayloom/scenes/procedural/statues.h>
#include <rayloom/scenes/summary.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace rayloom;
using namespace rayloom::scenes;

namespace {

Solid ball(float radius) {
  return {{glm::vec3(-radius), glm::vec3(radius)},
          [radius](glm::vec3 p) { return std::sqrt(glm::dot(p, p)) - radius; }};
}

}  // namespace

TEST_CASE("isosurface: a ball is closed, faces outwards and has its volume") {
  Geometry geometry;
  add_isosurface(geometry, ball(0.7f), 0.02f);
  CHECK(open_edges(geometry) == 0);
  CHECK(signed_volume(geometry) == Approx(4.0 / 3 * M_PI * 0.343).epsilon(0.005));
  float farthest = 0;
  for (const glm::vec3& p : geometry.positions) {
    farthest = std::max(farthest, std::fabs(std::sqrt(glm::dot(p, p)) - 0.7f));
  }
  CHECK(farthest < 0.002f);
}

TEST_CASE("isosurface: at least the triangles asked for, and not many more") {
  for (const uint64_t triangles : {2500u, 5000u, 50000u}) {
    Geometry geometry;
    add_isosurface_of(geometry, ball(1), triangles);
    CHECK(geometry.triangle_count() >= triangles);
    CHECK(geometry.triangle_count() < triangles * 15 / 10);
  }
  Geometry geometry;
  CHECK_THROWS_AS(add_isosurface(geometry, ball(1), 1e-4f), InputError);
}

TEST_CASE("every statue is closed, faces outwards, stands on the ground and fits its room") {
  for (const statues::Kind& kind : statues::kinds) {
    for (uint32_t seed = 0; seed < 4; ++seed) {
      Geometry geometry = kind.make(10000, seed);
      statues::fit(geometry, 1.85f, 1.25f);
      INFO(kind.name << " " << seed);
      CHECK(geometry.triangle_count() >= 10000);
      CHECK(geometry.triangle_count() < 10000 * 15 / 10);
      CHECK(open_edges(geometry) == 0);
      CHECK(repeated_edges(geometry) < 100);  // thin parts of such a coarse mesh may touch
      CHECK(signed_volume(geometry) > 0.01);
      Bounds bounds;
      for (const glm::vec3& p : geometry.positions) bounds.add(p);
      CHECK(bounds.min.y == 0);
      CHECK(bounds.max.y < 1.851f);
      CHECK(bounds.max.x - bounds.min.x < 1.251f);
      CHECK(bounds.max.z - bounds.min.z < 1.251f);
    }
  }
}

TEST_CASE("gallery: well formed, every statue another") {
  const Scene scene = load_scene("gallery:statues=12,triangles=20000");
  check_scene(scene, {"drape", "figure", "lattice"});
  std::set<uint64_t> counts;
  size_t found = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.name.find("statue ") != 0) continue;
    ++found;
    counts.insert(hash_of(Scene{"", {mesh}, {}, {}, {}, {}, {}, {}, {}, {}, {}}));
  }
  CHECK(found == 12);
  CHECK(counts.size() == 12);
}

TEST_CASE("gallery: four million triangles by default, dozens of statues") {
  const Scene scene = load_scene("gallery");
  const SceneSummary summary = summarize(scene);
  CHECK(summary.triangles >= 4000000);
  size_t found = 0;
  for (const Mesh& mesh : scene.meshes) found += mesh.name.find("statue ") == 0;
  CHECK(found == 36);
}

TEST_CASE("gallery: the same bits for any thread count") { check_thread_counts("gallery:statues=6,triangles=5000"); }

TEST_CASE("gallery: parameters are checked") {
  CHECK_THROWS_WITH(load_scene("gallery:statues=37"),
                    "gallery:statues=37: statues: 37 must be at least 1 and at most 36");
  CHECK_THROWS_AS(load_scene("gallery:triangles=4999"), InputError);
  CHECK_THROWS_WITH(load_scene("gallery:detail=2"),
                    Catch::Contains("detail: no such parameter; gallery has statues triangles"));
}
