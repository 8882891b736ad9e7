#include "procedural_checks.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/procedural/pictures.h>
#include <rayloom/scenes/procedural/tree.h>
#include <rayloom/scenes/procedural/tube.h>
#include <rayloom/scenes/summary.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace rayloom;
using namespace rayloom::scenes;

namespace {

glm::vec2 foot(const Instance& instance) { return {instance.transform[3], instance.transform[11]}; }

/// Part of a picture that is not cut away.
double coverage(const Pixels& pixels) {
  size_t solid = 0;
  for (size_t i = 3; i < pixels.bytes.size(); i += 4) solid += pixels.bytes[i] >= 128;
  return static_cast<double>(solid) / (static_cast<double>(pixels.bytes.size()) / 4);
}

float smallest_distance(const std::vector<Instance>& trees) {
  float least = std::numeric_limits<float>::infinity();
  for (size_t i = 0; i < trees.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const glm::vec2 apart = foot(trees[i]) - foot(trees[j]);
      least = std::fmin(least, std::sqrt(glm::dot(apart, apart)));
    }
  }
  return least;
}

/// Vertex by vertex.
Bounds all_vertices(const Scene& scene) {
  Bounds bounds;
  for (const Instance& instance : scene.instances) {
    const Transform3x4& m = instance.transform;
    for (const Geometry& g : scene.meshes[instance.mesh].geometries) {
      for (const glm::vec3& p : g.positions) {
        bounds.add({m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                    m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]});
      }
    }
  }
  return bounds;
}

std::vector<Instance> trees_of(const Scene& scene) {
  return {scene.instances.begin() + 1, scene.instances.end()};  // the ground comes first
}

}  // namespace

TEST_CASE("tube: closed, facing outwards, of the triangles promised") {
  const std::array<glm::vec3, 3> points = {{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}};
  const std::array<glm::vec3, 3> directions = {{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}};
  Geometry both;
  for (const uint32_t sides : {3u, 12u}) {
    Geometry one;
    const TubePath path{points, directions, 0.1f, 0.1f};
    add_tube(one, path, sides), add_tube(both, path, sides);
    CHECK(one.triangle_count() == tube_triangles(2, sides));
    CHECK(one.positions.size() == tube_vertices(2, sides));
    CHECK(open_edges(one) == 0);
    CHECK(repeated_edges(one) == 0);
    const double base = 0.005 * sides * std::sin(2 * M_PI / sides);
    // A prism, and a pyramid of the same height.
    CHECK(signed_volume(one) == Approx(base * (1 + 1.0 / 3)).epsilon(1e-5));
  }
  CHECK(both.triangle_count() == tube_triangles(2, 3) + tube_triangles(2, 12));
  CHECK(open_edges(both) == 0);
}

TEST_CASE("tree: closed wood, a card of two triangles for each leaf, different for each seed") {
  const TreeSpecies species{
      "twig", 0.1f, {{1, 0, 0, 2, 0, 0, 0.05f, 6, 5}, {4, 0.3f, 50, 0.5f, 0.3f, 0.3f, 0.1f, 3, 3}}, 7, 0.1f, {1, 1, 1}};
  const TreeMesh tree = make_tree(species, 1), other = make_tree(species, 2);
  CHECK(tree.wood.triangle_count() == 2 * 6 * 5 + 4 * 2 * 3 * 3);
  CHECK(tree.leaves.triangle_count() == 4 * 7 * 2);
  CHECK(open_edges(tree.wood) == 0);
  CHECK(signed_volume(tree.wood) > 0);
  CHECK(tree.wood.positions != other.wood.positions);
}

TEST_CASE("forest: well formed, with masked leaves of both coverages") {
  const Scene scene = load_scene("forest:trees=30");
  check_scene(scene);
  CHECK(scene.instances.size() == 31);
  const SceneSummary summary = summarize(scene);
  CHECK(summary.masked_materials == 4);
  for (const auto& image : scene.images) {
    INFO(image->name());
    CHECK(coverage(image->pixels()) > 0.15);
    CHECK(coverage(image->pixels()) < 0.75);
  }
  size_t masked = 0, opaque = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Geometry& g : mesh.geometries) {
      (scene.materials[g.material].alpha_mode == AlphaMode::mask ? masked : opaque) += g.triangle_count();
    }
  }
  CHECK(masked > 100000);
  CHECK(opaque > 100000);
}

TEST_CASE("forest: a hundred million triangles by default in little memory") {
  const SceneSummary summary = summarize(load_scene("forest"));
  CHECK(summary.instances == 4001);
  CHECK(summary.instanced_triangles >= 100000000);
  CHECK(summary.triangles < 2000000);
  CHECK(summary.geometry_bytes < 100000000);
}

TEST_CASE("forest: trees keep their distance from each other and from the path, and stand on the ground") {
  const Scene scene = load_scene("forest:trees=700");
  const std::vector<Instance> trees = trees_of(scene);
  REQUIRE(trees.size() == 700);
  CHECK(smallest_distance(trees) > 1.5f);
  const Geometry& ground = scene.meshes[0].geometries[0];
  for (size_t i = 0; i < trees.size(); i += 50) {
    float nearest = std::numeric_limits<float>::infinity(), height = 0;
    for (const glm::vec3& p : ground.positions) {
      const glm::vec2 apart = glm::vec2(p.x, p.z) - foot(trees[i]);
      if (glm::dot(apart, apart) < nearest) nearest = glm::dot(apart, apart), height = p.y;
    }
    CHECK(nearest < 0.5f);
    CHECK(std::fabs(height - trees[i].transform[7]) < 0.5f);
  }
}

TEST_CASE("world bounds: instances that are skipped make no difference") {
  for (const char* name : {"forest:trees=60", "forest:trees=61,seed=3", "atrium"}) {
    const Scene scene = load_scene(name);
    const Bounds fast = world_bounds(scene), slow = all_vertices(scene);
    CHECK(fast.min == slow.min);
    CHECK(fast.max == slow.max);
  }
}

TEST_CASE("forest: the same bits for any thread count, others for another seed") {
  check_thread_counts("forest:trees=40");
  CHECK(hash_of(load_scene("forest:trees=5")) != hash_of(load_scene("forest:trees=5,seed=2")));
}

TEST_CASE("forest: parameters are checked") {
  CHECK_THROWS_WITH(load_scene("forest:trees=0"), "forest:trees=0: trees: 0 must be at least 1 and at most 1000000");
  CHECK_THROWS_AS(load_scene("forest:seed=1000001"), InputError);
  CHECK_THROWS_WITH(load_scene("forest:tree=1"), Catch::Contains("tree: no such parameter; forest has seed trees"));
  CHECK(load_scene("forest:trees=1").instances.size() == 2);
}
