// The benches from outside: options, exit codes, JSON and files. No test gates on a time.

#include "../run_command.h"

#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

using namespace rayloom::tools;
using Json = nlohmann::json;

namespace {

Json parse(const Outcome& outcome) {
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return Json::parse(outcome.out);
}

bool has_embree(const Json& report) { return report["machine"]["embree_version"].is_string(); }

}  // namespace

TEST_CASE("Wrong options of a bench are exit code 2 and name the option") {
  struct Case {
    std::vector<std::string> arguments;
    const char* message;
  };
  const std::vector<Case> cases{
      {{"bench"}, "subcommand"},
      {{"bench", "paint"}, "there is no subcommand 'paint'; there are: build traversal"},
      {{"bench", "traversal", "--against", "optix"}, "--against"},
      {{"bench", "traversal", "--threads", "0"}, "--threads"},
      {{"bench", "traversal", "--threads", "1,1"}, "--threads"},
      {{"bench", "traversal", "--isa", "sse9"}, "--isa"},
      {{"bench", "traversal", "--size", "0"}, "--size"},
      {{"bench", "traversal", "--repetitions", "0"}, "--repetitions"},
      {{"bench", "traversal", "--batch", "0"}, "--batch"},
      {{"bench", "traversal", "--frobnicate"}, "See 'rayloom bench traversal --help'"},
      {{"bench", "build", "--against", "optix"}, "--against"},
      {{"bench", "build", "--threads", "x"}, "--threads"},
  };
  const Scratch scratch;
  for (const Case& wrong : cases) {
    CAPTURE(wrong.message);
    const Outcome outcome = scratch.rayloom(wrong.arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Catch::StartsWith("rayloom: ") && Catch::Contains(wrong.message));
  }
}

TEST_CASE("A bench's help leads with examples") {
  for (const char* bench : {"traversal", "build"}) {
    const Outcome help = Scratch().rayloom({"bench", bench, "--help"});
    CHECK(help.exit_code == 0);
    CHECK_THAT(help.out, Catch::Contains("Examples:\n  rayloom bench ") && Catch::Contains("--check"));
  }
}

TEST_CASE("A scene that is not there is exit code 3") {
  for (const char* bench : {"traversal", "build"}) {
    const Outcome outcome = Scratch().rayloom({"bench", bench, "no-such-scene"});
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.err, Catch::Contains("no-such-scene"));
  }
}

TEST_CASE("A traversal bench reports every set, and its hits agree with Embree's up to what the oracle explains") {
  const Scratch scratch;
  std::vector<std::string> arguments{"bench", "traversal", "cornell", "--json",        "-q", "--size",
                                     "16",    "--threads", "1,2",     "--repetitions", "1"};
  Json report = parse(scratch.rayloom(arguments));
  CHECK(report["schema"] == "rayloom.bench.traversal");
  CHECK(report["machine"]["threads"] >= 1);
  CHECK(report["rows"].size() == 2 * 13);  // threads x ways
  if (has_embree(report)) {
    arguments.insert(arguments.end(), {"--against", "embree"});
    report = parse(scratch.rayloom(arguments));
    CHECK(report["rows"][0]["peers"].size() == 2);
    CHECK(report["targets"].size() > 10);
  }
  for (const Json& row : report["rows"]) {
    CAPTURE(row.dump());
    CHECK(row["rays_per_second"]["median"] > 0);
    CHECK(row["rays_per_second"]["low"] <= row["rays_per_second"]["high"]);
    for (const Json& peer : row["peers"]) {
      CHECK(peer["ratio"]["median"] > 0);
      CHECK(peer["differences"]["theirs_exact"] == 0);
      CHECK(peer["differences"]["undecided"] == 0);
    }
  }
  CHECK(report["dispatch_ns_per_ray"].size() == 2);
  CHECK(report["memory"].size() >= 2);
}

TEST_CASE("A traversal bench keeps instances on two levels") {
  const Json report = parse(Scratch().rayloom({"bench", "traversal", "cornell", "--two-level", "--json", "-q", "--size",
                                               "16", "--threads", "1", "--repetitions", "1"}));
  CHECK(report["rows"].size() == 13);
  CHECK(report["rows"][0]["hit_share"] > 0.5);
}

TEST_CASE("A build bench reports every builder and draws the graph") {
  const Scratch scratch;
  const Json report = parse(scratch.rayloom(
      {"bench", "build", "cornell", "--json", "-q", "--size", "16", "-o", "out", "--repetitions", "1"}));
  CHECK(report["schema"] == "rayloom.bench.build");
  REQUIRE(report["rows"].size() >= 2);
  for (const Json& row : report["rows"]) {
    CAPTURE(row.dump());
    CHECK(row["builds"].size() == 2);
    CHECK(row["builds"][0]["triangles_per_second"]["median"] > 0);
    CHECK(row["rays_per_second"]["median"] > 0);
    CHECK(row["bytes_per_triangle"] > 0);
    const bool whole = row["ours"] && row["builder"] != "lazy";  // of a lazy structure only the top is there
    if (whole) CHECK(row["children_per_node"] >= 1);
  }
  CHECK_THAT(scratch.listing(), Catch::Contains("out/build.html") && Catch::Contains("out/build.csv") &&
                                    Catch::Contains("out/effective_rate_cornell.csv") &&
                                    Catch::Contains("out/effective_rate_cornell.svg"));
  CHECK_THAT(scratch.read("out/effective_rate_cornell.svg"), Catch::Contains("binned_sah"));
}

TEST_CASE("A missed target is exit code 1 under --check, and is named") {
  const Scratch scratch;
  // One triangle cannot do with 54 bytes.
  const Outcome outcome = scratch.rayloom(
      {"bench", "traversal", "triangle", "--check", "--size", "8", "--threads", "1", "--repetitions", "1"});
  CHECK(outcome.exit_code == 1);
  CHECK_THAT(outcome.err, Catch::Contains("target missed: triangle: bytes per triangle"));
  CHECK_THAT(outcome.out, Catch::Contains("MISSED"));
}

TEST_CASE("Features that a scene does not use cost the kernels no instruction") {
  const Outcome outcome =
      Scratch().rayloom({"bench", "traversal", "cornell", "--features", "--size", "6", "--check", "--json"});
  if (outcome.err.find("valgrind") != std::string::npos) {
    WARN("valgrind is not installed: not tested");
    return;
  }
  const Json report = parse(outcome);
  CHECK(report["features"]["rows"].size() == 6);
  CHECK(report["targets"].size() == 5);
}
