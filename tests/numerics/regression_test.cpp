#include <rayloom/base/error.h>
#include <rayloom/tools/bench/numerics/failing_ray.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::bench::numerics;

TEST_CASE("every ray that ever failed agrees with the rationals") {
  const auto rays = read_failing_rays(RAYLOOM_REGRESSION_RAYS);
  for (const FailingRay& ray : rays) {
    CAPTURE(to_line(ray));
    CHECK(replay(ray) == "");
  }
}

TEST_CASE("a kept ray reads back bit for bit") {
  FailingRay ray{"K1", 7, 2, 12345, {{0x1.234p-149f, -0.0f, 1e30f}, 0, {1, -2, 0x1p-149f}, INFINITY}, {}};
  ray.triangles.push_back({{{1, 2, 3}, {4, 5, 6}, {-7, 8, 0.1f}}});
  const FailingRay read = parse_failing_ray(to_line(ray), "here");
  CHECK(to_line(read) == to_line(ray));
  CHECK(read.seed == 7);
  CHECK(std::isinf(read.ray.t_max));
  CHECK(read.triangles == ray.triangles);
}

TEST_CASE("a damaged line is refused with its place") {
  for (const char* line :
       {"K1 seed x", "K1 seed 1 part 2 index 3 ray 1 2", "K1 seed 1 part 2 index 3 ray 1 2 3 4 5 6 7 8x",
        "K1 seed 1 part 2 index 3 ray 1 2 3 4 5 6 7 8 square"})
    CHECK_THROWS_WITH(parse_failing_ray(line, "file:9"), Catch::Contains("file:9"));
  CHECK_THROWS_AS(read_failing_rays("/nowhere/rays.txt"), InputError);
}
