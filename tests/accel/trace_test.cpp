#include "brute_force.h"
#include "random.h"

#include <rayloom/accel/walk.h>

#include <catch2/catch.hpp>

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

Ray random_ray(Random& random, float reach) {
  const auto any = [&] { return random.uniform(-reach, reach); };
  return ray_between({any(), any(), any()}, {any(), any(), any()});
}

void compare_with_brute_force(const Mesh& mesh, const std::vector<Ray>& rays) {
  const Block block = build_mesh(mesh);
  const auto triangles = all_triangles({mesh.geometry()});
  for_each_isa([&](Isa isa) {
    REQUIRE(current_isa() == isa);
    size_t different = 0;
    for (const Ray& ray : rays)
      different += !same_bits(trace({}, request_for(block, ray)), closest_of(all_hits(triangles, ray), ray));
    CHECK(different == 0);
  });
}

}  // namespace

TEST_CASE("closest hits equal brute force bit for bit") {
  Random random(1);
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) rays.push_back(random_ray(random, 1.5f));
  compare_with_brute_force(bumpy_sphere(3), rays);
  compare_with_brute_force(torus(40, 20, 0.3f), rays);
  compare_with_brute_force(cube(3), rays);
}
