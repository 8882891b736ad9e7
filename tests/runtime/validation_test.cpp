// ERR-07, ERR-09: what the validation layer tells, and that it tells the same for any thread count.

#include "program.h"

#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;

TEST_CASE("each row is told once a dispatch, with the lowest thread's text and the count of all") {
  for (const unsigned threads : {1u, 2u, 5u})
    for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
      Program program;
      program.shaders.RayGeneration("rg", [](RayGenContext& ctx) {
        const uint x = ctx.DispatchRaysIndex().x;
        Value payload{0};
        const uint flags = x >= 200 ? 0x30 : 0;
        ctx.TraceRay({}, flags, 0xFF, 0, 0, x >= 17 ? x : 0, straight_ray(), payload);
      });
      program.shaders.Miss("ms", [](MissContext&, Value&) {});
      program.create("rg", {"ms"});
      DispatchOptions options;
      options.mode = mode;
      const ThreadLimit limit(threads);
      program.run(300, 1, 1, options);
      REQUIRE(program.messages.size() == 2);
      CHECK(program.messages[0].id == "RF-10");
      CHECK(program.messages[0].count == 100);
      CHECK(program.messages[1].id == "ST-18");
      CHECK(program.messages[1].count == 283);
      CHECK_THAT(program.messages[1].text, Catch::Matchers::StartsWith("record 17 "));
      CHECK(program.messages[1].severity == ValidationSeverity::error);
    }
}

TEST_CASE("ERR-04: a pipeline stack size that is none is dropped, and told, whoever listens by then") {
  Program program;
  program.shaders.RayGeneration("rg", [](RayGenContext&) {});
  program.create("rg");
  const uint64_t before = program.pipeline->GetPipelineStackSize();
  program.pipeline->SetPipelineStackSize(before + 1);
  CHECK(program.messages.empty());
  program.pipeline->SetPipelineStackSize(0xffffffff);
  CHECK(program.pipeline->GetPipelineStackSize() == before + 1);
  REQUIRE(program.messages.size() == 1);
  CHECK(program.messages[0].id == "ERR-04");
  program.device.set_validation_callback({});
  program.pipeline->SetPipelineStackSize(~uint64_t{0});
  CHECK(program.pipeline->GetPipelineStackSize() == before + 1);
  CHECK(program.messages.size() == 1);
}

TEST_CASE("without a callback nothing is told and nothing else changes") {
  Program program;
  program.device.set_validation_callback({});
  program.shaders.RayGeneration("rg", [](RayGenContext& ctx) {
    Value payload{0};
    ctx.TraceRay({}, 0xFFFFFFFF, 0, 0, 0, 99, straight_ray(), payload);
  });
  program.create("rg");
  CHECK(program.run(10).statistics.rays == 10);
  CHECK(program.messages.empty());
}
