// What a laboratory is worth that finds nothing wrong with anything: the same rows, on the same rays, against a plain
// float tracer. Each row named here must catch it.

#include <rayloom/tools/bench/numerics/lab.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::bench::numerics;

namespace {

/// What each row must find wrong with the plain tracer, and not merely something.
struct Fault {
  const char* row;
  std::vector<const char*> figures;
};

const Fault faults[] = {
    {"K1", {"leaks", "wrong parity", "not exactly one", "different from the rationals"}},
    {"K2", {"leaks", "not exactly one", "leaks, fans and poles", "different from the rationals"}},
    {"K3", {"not exactly one, convex meshes", "not exactly one, grid and axis rays"}},
    {"K4", {"leaks, 2^-100 to 2^100, 1e-30 to 1e30", "wrong parity, 1e-12 detail in a body of 1e6"}},
    {"K5", {"leaks, offsets 1 to 1e7", "other closest t than brute force"}},
    {"K7", {"false misses", "false hits", "t error, largest", "u, v error, largest", "t error, largest, in instances"}},
    {"K8", {"false misses", "false hits", "t error, largest", "u, v error, largest"}},
    {"K9", {"false misses", "t error, largest", "leaks, sliver fans", "not exactly one, sliver fans"}},
    {"K10", {"hits of collinear and repeated corners", "subnormal triangles different from the rationals"}},
    {"K11", {"not the smallest name, 2 copies in 2 geometries in 2 instances", "not the first of coplanar quads"}},
    {"K12", {"boxes of a hit missed"}},
    {"K13", {"leaks", "other closest t than brute force"}},
    {"K15", {"boxes missed by axis rays on the grid", "other hits than brute force, integer heights"}},
    {"K16", {"other hits than brute force, components 2^-149 to 2^127"}},
    {"K19", {"triangles wrongly in or out", "t at the end different from the rationals"}},
    {"K20", {"walks that lose or repeat a hit"}},
    {"K21", {"hits that differ from those of the fixed state"}},
    {"K22", {"hits that differ from those of the fixed state"}},
    {"T2", {"leaks of a closed mesh in an instance", "displacement over its bound, largest"}},
    {"T3", {"hits of an instance without an inverse, or of its neighbour lost"}},
    {"T6", {"self-hits"}},
    {"T8", {"paths that left a closed box"}}};

}  // namespace

TEST_CASE("a plain float tracer fails the rows that look at what it gets wrong, in what it gets wrong") {
  for (const Fault& fault : faults) {
    const RowResult result = run_row(find_row(fault.row), plain_subject(), Tier::quick, 1);
    for (const std::string name : fault.figures) {
      CAPTURE(fault.row, name);
      const auto figure =
          std::find_if(result.figures.begin(), result.figures.end(), [&](const Figure& f) { return f.name == name; });
      REQUIRE(figure != result.figures.end());
      CHECK_FALSE(figure->passes());
    }
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
