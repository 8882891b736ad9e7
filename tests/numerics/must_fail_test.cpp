// What a laboratory is worth that finds nothing wrong with anything: the same rows, on the same rays, against a plain
// float tracer. Each row named here must catch it.

#include <rayloom/tools/bench/numerics/lab.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::bench::numerics;

TEST_CASE("a plain float tracer fails the rows that look at what it gets wrong") {
  for (const char* id : {"K1", "K2", "K3", "K4", "K5", "K7", "K8", "K9", "K10", "K11", "K12", "K13", "K15", "K21",
                         "K22", "T2", "T6", "T8"}) {
    const RowResult result = run_row(find_row(id), plain_subject(), Tier::quick, 1);
    CAPTURE(id);
    CHECK_FALSE(result.passes());
  }
}

TEST_CASE("what fails is kept with its triangles and shown to differ") {
  const RowResult result = run_row(find_row("K7"), plain_subject(), Tier::quick, 1);
  REQUIRE(!result.failing.empty());
  for (const FailingRay& ray : result.failing) {
    CHECK(ray.row == "K7");
    CHECK(ray.triangles.size() == 1);
    CHECK(difference_from_exact(plain_subject(), ray.ray, ray.triangles[0]) != "");
    CHECK(replay(ray) == "");
  }
}
