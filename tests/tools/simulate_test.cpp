// The simulated GPU from the command line: its picture, its files, its sums.

#include <rayloom/tools/image_io.h>

#include "run_command.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace rayloom::tools;

namespace {

std::vector<std::string> small_simulation(const std::string& scene) {
  return {"simulate", scene, "-o", "out", "--size", "24x16", "--spp", "1"};
}

}  // namespace

TEST_CASE("The simulated picture equals the native one and all files are there") {
  const Scratch scratch;
  const std::string scene = GENERATE(as<std::string>(), "cornell", "spheres");
  const Outcome outcome = scratch.rayloom(small_simulation(scene));
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Catch::Contains("equal bit for bit"));
  for (const char* file : {"picture.exr", "cycles.exr", "cycles.png", "stats.json", "stats.txt"}) {
    CHECK_THAT(scratch.listing(), Catch::Contains(std::string("out/") + file));
  }
  CHECK(scratch.rayloom({"render", scene, "-o", "native.exr", "--size", "24x16", "--spp", "1"}).exit_code == 0);
  CHECK(scratch.rayloom({"diff", "out/picture.exr", "native.exr"}).exit_code == 0);
}

TEST_CASE("Thread count changes nothing in the simulation's numbers") {
  const Scratch scratch;
  std::string first;
  for (const char* threads : {"1", "3"}) {
    auto arguments = small_simulation("cornell");
    arguments.insert(arguments.end(), {"--threads", threads});
    REQUIRE(scratch.rayloom(arguments).exit_code == 0);
    const std::string cycles = scratch.read("out/cycles.exr");
    if (first.empty()) first = cycles;
    CHECK(cycles == first);
  }
}
