// What every subcommand owes its user: help, exit codes, streams, usage errors that name the option and its range.

#include "run_command.h"

#include <catch2/catch.hpp>

using namespace rayloom::tools;

TEST_CASE("Help leads with examples and goes to standard output") {
  const Scratch scratch;
  for (const char* sub : {"render", "simulate", "diff", "bvh", "scene"}) {
    CAPTURE(sub);
    const Outcome help = scratch.rayloom({sub, "--help"});
    CHECK(help.exit_code == 0);
    CHECK(help.err.empty());
    const size_t examples = help.out.find("Examples:\n  rayloom "), usage = help.out.find("Usage: rayloom ");
    CHECK(examples != std::string::npos);
    CHECK(usage != std::string::npos);
    CHECK(examples < usage);
  }
  CHECK(scratch.rayloom({"--help"}).exit_code == 0);
}

TEST_CASE("The version names compiler, commit, instruction sets and float flags") {
  const Outcome version = Scratch().rayloom({"--version"});
  CHECK(version.exit_code == 0);
  CHECK(version.err.empty());
  for (const char* fact : {"rayloom ", "commit: ", "compiler: ", "-ffp-contract=off", "scalar", "(in use)"}) {
    CHECK_THAT(version.out, Catch::Contains(fact));
  }
}

TEST_CASE("A wrong command line is exit code 2, one clear message and an empty standard output") {
  struct Case {
    std::vector<std::string> arguments;
    const char* message;
  };
  const std::vector<Case> cases{
      {{}, "subcommand"},
      {{"paint"}, "there is no subcommand 'paint'"},
      {{"render"}, "SCENE"},
      {{"render", "cornell"}, "-o"},
      {{"render", "cornell", "-o", "a.jpg"}, ".exr"},
      {{"render", "cornell", "-o", "a.exr", "--sizes", "4x4"}, "--sizes"},
      {{"render", "cornell", "-o", "a.exr", "--size", "0x0"}, "--size"},
      {{"render", "cornell", "-o", "a.exr", "--size", "4x-4"}, "--size"},
      {{"render", "cornell", "-o", "a.exr", "--size", "65536x65536"}, "--size"},
      {{"render", "cornell", "-o", "a.exr", "--size", "99999999999999999999x1"}, "--size"},
      {{"render", "cornell", "-o", "a.exr", "--spp", "0"}, "--spp"},
      {{"render", "cornell", "-o", "a.exr", "--spp", "-3"}, "--spp"},
      {{"render", "cornell", "-o", "a.exr", "--spp", "1e3"}, "--spp"},
      {{"render", "cornell", "-o", "a.exr", "--threads", "1025"}, "--threads"},
      {{"render", "cornell", "-o", "a.exr", "--seed", "x"}, "--seed"},
      {{"render", "cornell", "-o", "a.exr", "--isa", "sse9"}, "--isa"},
      {{"render", "cornell", "-o", "a.exr", "--mode", "fast"}, "--mode"},
      {{"render", "cornell", "-o", "a.exr", "--shader", "toon"}, "--shader"},
      {{"render", "cornell", "-o", "a.exr", "--aov", "Z,,N"}, "--aov"},
      {{"render", "cornell", "-o", "a.exr", "--aov", "smell"}, "--aov"},
      {{"render", "cornell", "-o", "a.exr", "--max-bounces", "1000000"}, "--max-bounces"},
      {{"render", "cornell", "-o", "a.exr", "--exposure", "nan"}, "--exposure"},
      {{"render", "cornell", "-o", "a.exr", "--environment", "1,2"}, "--environment"},
      {{"render", "cornell", "-o", "a.exr", "--environment", "1,-2,3"}, "--environment"},
      {{"render", "cornell", "--pixel", "4,4", "--size", "4x4"}, "--pixel"},
      {{"render", "cornell", "--pixel", "4"}, "--pixel"},
      {{"render", "cornell", "-o", "a.exr", "--camera", "nonsense"}, "--camera"},
      {{"render", "cornell", "-o", "a.exr", "--spp", "4", "--spp", "8"}, "--spp"},
      {{"simulate", "cornell"}, "-o"},
      {{"simulate", "cornell", "-o", "d", "--gpu", "voodoo2"}, "voodoo2"},
      {{"simulate", "cornell", "-o", "d", "--set", "sm.warps"}, "sm.warps"},
      {{"simulate", "cornell", "-o", "d", "--set", "no.such.key=1"}, "no.such.key"},
      {{"diff", "a.exr"}, "B"},
      {{"diff", "a.exr", "b.exr", "--metric", "ssim"}, "ssim"},
      {{"diff", "a.exr", "b.exr", "--max", "-1"}, "--max"},
      {{"diff", "a.exr", "b.exr", "--max", "nan"}, "--max"},
      {{"bvh"}, "SCENE"},
      {{"bvh", "cornell", "--prefer", "beauty"}, "--prefer"},
      {{"scene"}, "SCENE"},
  };
  const Scratch scratch;
  for (const Case& wrong : cases) {
    std::string command;
    for (const std::string& argument : wrong.arguments) command += argument + " ";
    CAPTURE(command);
    const Outcome outcome = scratch.rayloom(wrong.arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Catch::StartsWith("rayloom: ") && Catch::Contains(wrong.message));
  }
  CHECK(scratch.listing().empty());
}
