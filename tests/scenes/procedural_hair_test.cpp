#include "procedural_checks.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/summary.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace rayloom;
using namespace rayloom::scenes;

namespace {

/// Longest side against the height over it, for every triangle of the hair; sorted.
std::vector<double> aspects(const Scene& scene) {
  std::vector<double> result;
  for (const Geometry& g : scene.meshes.at(1).geometries) {
    for (size_t i = 0; i < g.indices.size(); i += 3) {
      const glm::dvec3 a(g.positions[g.indices[i]]), b(g.positions[g.indices[i + 1]]), c(g.positions[g.indices[i + 2]]);
      const glm::dvec3 ab = b - a, ac = c - a, bc = c - b, area = glm::cross(ab, ac);
      const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
      result.push_back(longest / std::sqrt(glm::dot(area, area)));
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

TEST_CASE("hair: well formed, six triangles a segment, closed strands") {
  const Scene scene = load_scene("hair:strands=301,segments=12");
  check_scene(scene);
  REQUIRE(scene.meshes.size() == 2);
  uint64_t triangles = 0;
  for (const Geometry& g : scene.meshes[1].geometries) {
    triangles += g.triangle_count();
    CHECK(open_edges(g) == 0);
    CHECK(signed_volume(g) > 0);
  }
  CHECK(triangles == 301 * 6 * 12);
  CHECK(open_edges(scene.meshes[0].geometries[0]) == 0);
}

TEST_CASE("hair: tens of thousands of strands by default") {
  const SceneSummary summary = summarize(load_scene("hair"));
  CHECK(summary.triangles > 40000 * 6 * 20);
  CHECK(summary.instanced_triangles == summary.triangles);
}

TEST_CASE("hair: most triangles are at least a hundred times as long as high") {
  const std::vector<double> sorted = aspects(load_scene("hair:strands=2000"));
  CHECK(sorted[sorted.size() / 2] > 150);
  CHECK(sorted[sorted.size() / 10] > 100);
  CHECK(sorted.back() < 5000);
}

TEST_CASE("hair: strands stay close to the head and hang down") {
  const Scene scene = load_scene("hair:strands=2000");
  Bounds hair;
  for (const Geometry& g : scene.meshes.at(1).geometries) {
    for (const glm::vec3& p : g.positions) hair.add(p);
  }
  CHECK(hair.max.y < 0.16f);
  CHECK(hair.min.y > -0.36f);
  CHECK(hair.max.x < 0.22f);
  CHECK(hair.min.x > -0.22f);
}

TEST_CASE("hair: the same bits for any thread count") {
  check_thread_counts("hair:strands=3000,segments=8");
  CHECK(hash_of(load_scene("hair:strands=10,curl=0")) != hash_of(load_scene("hair:strands=10,curl=50")));
}

TEST_CASE("hair: parameters are checked") {
  CHECK_THROWS_WITH(load_scene("hair:segments=3"), "hair:segments=3: segments: 3 must be at least 4 and at most 128");
  CHECK_THROWS_AS(load_scene("hair:strands=0"), InputError);
  CHECK_THROWS_AS(load_scene("hair:curl=101"), InputError);
  CHECK_THROWS_AS(load_scene("hair:micrometres=9"), InputError);
  CHECK_THROWS_WITH(load_scene("hair:length=9"), Catch::Contains("length: no such parameter"));
  CHECK(load_scene("hair:strands=1,segments=4").meshes[1].geometries.size() == 1);
}
