// rayloom bench error from outside: what it writes, what it keeps, what it refuses.

#include "../../run_command.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace rayloom::tools;

namespace {

Outcome bench_error(const Scratch& scratch, std::vector<std::string> more) {
  std::vector<std::string> arguments{"bench", "error",  "large-lamps", "--spp", "1,4",       "--seeds",
                                     "2",     "--size", "24x16",       "-q",    "--sampler", "owen-sobol"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return scratch.rayloom(arguments);
}

}  // namespace

TEST_CASE("tables, charts and a page are written, and the reference is kept for the next run") {
  const Scratch scratch;
  const std::vector<std::string> once{"--estimator", "mis,light", "--reference", "kept.exr", "--json=a.json"};
  const Outcome outcome = bench_error(scratch, once);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto first = nlohmann::json::parse(scratch.read("a.json"));
  CHECK(first["schema"] == "rayloom.bench.error");
  const auto& scene = first["scenes"][0];
  CHECK(scene["scene"] == "large-lamps");
  CHECK(scene["reference"]["spp"] == 400);
  CHECK(scene["reference"]["cached"] == false);
  REQUIRE(scene["configurations"].size() == 2);
  const auto& points = scene["configurations"][0]["points"];
  CHECK(points[0]["relmse"]["value"] > points[1]["relmse"]["value"]);
  CHECK(points[1]["seconds"]["median"] > 0);

  REQUIRE(bench_error(scratch, {"--estimator", "mis,light", "--reference", "kept.exr", "--json=b.json"}).exit_code ==
          0);
  const auto second = nlohmann::json::parse(scratch.read("b.json"))["scenes"][0];
  CHECK(second["reference"]["cached"] == true);
  CHECK(second["reference"]["key"] == scene["reference"]["key"]);
  CHECK(second["configurations"][0]["points"][1]["relmse"] == points[1]["relmse"]);  // bit for bit
  CHECK(second["reference"]["own_relmse"] == scene["reference"]["own_relmse"]);

  REQUIRE(bench_error(scratch, {"--estimator", "mis", "--reference", "kept.exr", "--max-bounces", "2", "--json=c.json"})
              .exit_code == 0);
  CHECK(nlohmann::json::parse(scratch.read("c.json"))["scenes"][0]["reference"]["cached"] == false);
}

TEST_CASE("a directory of results") {
  const Scratch scratch;
  const Outcome outcome = bench_error(scratch, {"--estimator", "mis", "-o", "out"});
  INFO(outcome.err);
  if (outcome.err.find("gnuplot") != std::string::npos) return;  // named as missing: the CSV files are there
  REQUIRE(outcome.exit_code == 0);
  const std::string listing = scratch.listing();
  for (const char* name : {"error.html", "errors.csv", "slopes.csv", "ratios.csv", "references.csv",
                           "large_lamps_error_samples.svg", "large_lamps_error_seconds.svg"})
    CHECK(listing.find(name) != std::string::npos);
  CHECK(outcome.out.find("slope of MSE") != std::string::npos);
}

TEST_CASE("what makes no sense is refused by name") {
  const Scratch scratch;
  const auto refuses = [&](std::vector<std::string> arguments, int code, const std::string& why) {
    const Outcome outcome = bench_error(scratch, std::move(arguments));
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == code);
    CHECK(outcome.err.find(why) != std::string::npos);
  };
  refuses({"--estimator", "guess"}, 2, "--estimator: 'guess'");
  refuses({"--reference-spp", "399"}, 2, "--reference-spp");
  refuses({"--reference", "kept.png"}, 2, "--reference");
  refuses({"--reference", "no/such/dir.exr"}, 3, "no/such/dir.exr");
  scratch.write("text.exr", "no picture");
  refuses({"--reference", "text.exr"}, 3, "text.exr");
  for (const char* spp : {"4", "4,1", "4,4", "0,1", "1,,2", "a"}) {
    const Outcome outcome = scratch.rayloom({"bench", "error", "cornell", "--spp", spp});
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.err.find("--spp") != std::string::npos);
  }
  CHECK(scratch.rayloom({"bench", "error", "--seeds", "1"}).exit_code == 2);
  CHECK(scratch.rayloom({"bench", "error", "nowhere.glb", "-q"}).exit_code == 3);
}
