#include "procedural_checks.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/procedural/relief.h>
#include <rayloom/scenes/summary.h>

#include <catch2/catch.hpp>
#include <cmath>

using namespace rayloom;
using namespace rayloom::scenes;

TEST_CASE("terrain: well formed, lit, seen by three cameras above the ground") {
  const Scene scene = load_scene("terrain:resolution=120");
  check_scene(scene);
  CHECK(scene.lights.size() == 1);
  REQUIRE(scene.cameras.size() == 3);
  const Relief relief(1);
  for (const SceneCamera& camera : scene.cameras) {
    CHECK(camera.position.y > relief.height({camera.position.x, camera.position.z}));
    CHECK(camera.position.y > 0);
  }
}

TEST_CASE("terrain: two triangles a cell, four million by default, and several materials") {
  CHECK(summarize(load_scene("terrain:resolution=8")).triangles == 2 * 8 * 8 + 2);
  CHECK(summarize(load_scene("terrain:resolution=300")).triangles == 2 * 300 * 300 + 2);
  const SceneSummary summary = summarize(load_scene("terrain"));
  CHECK(summary.triangles >= 4000000);
  CHECK(summary.instanced_triangles == summary.triangles);
  CHECK(summary.materials == 5);
  CHECK(summary.geometries == 5);
}

TEST_CASE("terrain: materials share their borders without a gap") {
  const Scene scene = load_scene("terrain:resolution=64");
  Geometry all;
  for (const Geometry& g : scene.meshes.at(0).geometries) {
    const auto first = static_cast<uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), g.positions.begin(), g.positions.end());
    for (const uint32_t index : g.indices) all.indices.push_back(first + index);
  }
  CHECK(open_edges(all) == 4 * 64);
  CHECK(repeated_edges(all) == 0);  // only the rim
}

TEST_CASE("gradient noise: the slope is the derivative of the value") {
  for (int i = 0; i < 500; ++i) {
    const glm::vec2 p(-31.3f + 0.191f * static_cast<float>(i), 18.7f - 0.173f * static_cast<float>(i));
    const glm::vec2 right(0x1p-7f, 0), up(0, 0x1p-7f);
    const Slope here = gradient_noise(p, 5);
    const glm::vec2 rise(gradient_noise(p + right, 5).value - gradient_noise(p - right, 5).value,
                         gradient_noise(p + up, 5).value - gradient_noise(p - up, 5).value);
    CHECK(here.slope.x == Approx(rise.x * 64).margin(5e-3));
    CHECK(here.slope.y == Approx(rise.y * 64).margin(5e-3));
    CHECK(std::fabs(here.value) < 1.6f);
  }
}

TEST_CASE("terrain: the same bits for any thread count, others for another seed") {
  check_thread_counts("terrain:resolution=200");
  CHECK(hash_of(load_scene("terrain:resolution=64")) == hash_of(load_scene("terrain:resolution=64,seed=1")));
  CHECK(hash_of(load_scene("terrain:resolution=64")) != hash_of(load_scene("terrain:resolution=64,seed=2")));
}

TEST_CASE("terrain: parameters are checked") {
  CHECK_THROWS_WITH(load_scene("terrain:resolution=7"),
                    "terrain:resolution=7: resolution: 7 must be at least 8 and at most 4096");
  CHECK_THROWS_AS(load_scene("terrain:resolution=4097"), InputError);
  CHECK_THROWS_AS(load_scene("terrain:seed=-1"), InputError);
  CHECK_THROWS_WITH(load_scene("terrain:cells=9"), Catch::Contains("no such parameter; terrain has resolution seed"));
}
