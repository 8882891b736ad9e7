// The rays a bench traces: how many, where from, and the same for every tree.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/ray_sets.h>
#include <rayloom/tools/bench/traced_rays.h>

#include <cstring>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::bench;

namespace {

bool same_rays(const Rays& a, const Rays& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(accel::Ray)) == 0;
}

}  // namespace

TEST_CASE("Pixels follow the Morton curve") {
  const uint32_t expected[][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0}, {3, 0}, {2, 1}, {3, 1}, {0, 2}};
  for (uint64_t i = 0; i < std::size(expected); ++i) {
    CHECK(morton_pixel(i).x == expected[i][0]);
    CHECK(morton_pixel(i).y == expected[i][1]);
  }
}

TEST_CASE("A scene's ray sets start where primary rays hit, and do not depend on the tree") {
  const BenchScene scene = load_bench_scene("cornell", "");
  const OurStructure sah(scene, {0, accel::Builder::binned_sah}), fast(scene, accel::build_flag::prefer_fast_trace);
  const RaySets sets = make_ray_sets(scene, sah, 24), again = make_ray_sets(scene, fast, 24);
  CHECK(sets.primary.size() == 24 * 24);
  CHECK(sets.bounce.size() > 100);
  CHECK(sets.bounce.size() == sets.ambient.size());
  CHECK(sets.bounce.size() == sets.shadow.size());
  CHECK(sets.bounce.size() == sets.shuffled.size());
  CHECK_FALSE(same_rays(sets.bounce, sets.shuffled));
  CHECK(same_rays(sets.primary, again.primary));
  CHECK(same_rays(sets.bounce, again.bounce));
  CHECK(same_rays(sets.shadow, again.shadow));
  CHECK(sets.ambient[0].t_max < sets.bounce[0].t_max);
  CHECK(sets.shadow[0].t_max == 1);
}

TEST_CASE("All our ways of tracing give the same hits") {
  const BenchScene scene = load_bench_scene("cornell", "");
  const OurStructure structure(scene);
  const Rays rays = make_ray_sets(scene, structure, 20).bounce;
  std::vector<accel::Hit> batches(rays.size()), warps(rays.size()), singles(rays.size()), threads(rays.size());
  trace_in_batches(structure, 0, 4096)(rays, batches);
  trace_in_batches(structure, 0, 32)(rays, warps);
  trace_one_by_one(structure, 0)(rays, singles);
  trace_all(trace_in_batches(structure, 0, 7), rays, threads, 2);
  for (size_t i = 0; i < rays.size(); ++i) {
    for (const accel::Hit* other : {&warps[i], &singles[i], &threads[i]}) {
      REQUIRE(batches[i].type == other->type);
      REQUIRE(batches[i].t == other->t);
      REQUIRE(batches[i].primitive_index == other->primitive_index);
    }
  }
}

TEST_CASE("A scene over the limit keeps its instances, and its triangles are the same ones") {
  const BenchScene flat = load_bench_scene("cornell", ""), placed = load_bench_scene("cornell", "", 0);
  CHECK_FALSE(flat.two_level());
  CHECK(placed.two_level());
  CHECK(flat.effective_triangles() == placed.effective_triangles());
  CHECK(flat.meshes.size() == 1);
  const OurStructure one(flat), two(placed);
  const RaySets a = make_ray_sets(flat, one, 16), b = make_ray_sets(placed, two, 16);
  CHECK(a.bounce.size() == b.bounce.size());
}

TEST_CASE("A scene that is not there, or has no triangles, is an input error that names it") {
  CHECK_THROWS_AS(load_bench_scene("no-such-scene", "/nonexistent"), InputError);
  CHECK_THROWS_WITH(load_bench_scene("spheres", ""), Catch::Contains("spheres") && Catch::Contains("no triangles"));
  CHECK_FALSE(bench_scene_exists("no-such-scene", ""));
  CHECK(bench_scene_exists("triangle", ""));
}
