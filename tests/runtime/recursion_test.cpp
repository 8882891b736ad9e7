// Rows RC, CA, ERR-01, SID-14: depth, callables and stack.

#include "program.h"

#include <rayloom/base/error.h>
#include <rayloom/runtime/device_removed.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;
using Catch::Matchers::Contains;

namespace {

struct Deep {
  uint depth;
  uint wanted;
  uint words[254];  // 1 KiB together
};

/// Closest-hit traces again until `wanted` traces are nested; every level checks its payload on the way back.
void make_recursive(Program& program, const Buffer& log, uint wanted) {
  const auto out = log.rw_structured<uint>();
  const auto scene = program.scene(program.layers({1}));
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    Deep payload{1, wanted, {}};
    if (wanted) ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    out[ctx.DispatchRaysIndex().x] = payload.words[7];
  });
  program.shaders.ClosestHit("ch", [=](ClosestHitContext& ctx, Deep& payload, const Barycentrics&) {
    if (payload.depth < payload.wanted) {
      Deep inner{payload.depth + 1, payload.wanted, {}};
      ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), inner);
      payload.words[7] = inner.words[7];
    }
    payload.words[7] += 1;
  });
  program.hit_group("hg", "ch");
  program.create("rg", {""}, {"hg"});
}

DispatchOptions in_mode(ExecutionMode mode) {
  DispatchOptions options;
  options.mode = mode;
  return options;
}

}  // namespace

TEST_CASE("RC-01, RC-06, RC-08: 31 nested traces with 1 KiB payloads on the default stack, and one too many") {
  for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct})
    for (const uint depth : {1u, 31u}) {
      Program program(depth);
      const Buffer log = program.counters();
      make_recursive(program, log, depth);
      CHECK(program.run(40, 1, 1, in_mode(mode)).statistics.closest_hit == 40 * depth);
      for (uint i = 0; i < 40; ++i) CHECK(log.as<uint>()[i] == depth);
    }
}

TEST_CASE("RC-01, RC-02, ERR-01: tracing at the declared depth removes the device, and only that one") {
  for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct})
    for (const uint depth : {0u, 1u, 5u}) {
      Program program(depth), other(1);
      const Buffer log = program.counters(), other_log = other.counters();
      make_recursive(program, log, depth + 1);
      make_recursive(other, other_log, 1);
      CHECK_THROWS_WITH(program.run(40, 1, 1, in_mode(mode)), Contains("RC-01"));
      CHECK_THROWS_AS(program.run(), DeviceRemoved);
      CHECK_THAT(program.device.GetDeviceRemovedReason(), Contains("RC-01"));
      CHECK(other.run().statistics.closest_hit == 1);
      CHECK(other.device.GetDeviceRemovedReason().empty());
    }
}

TEST_CASE("a shader cannot swallow the removal of its device") {
  Program program(1);
  program.shaders.RayGeneration("rg", [](RayGenContext& ctx) {
    NoPayload payload;
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.Miss("ms", [](MissContext& ctx, NoPayload& payload) {
    try {
      ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    } catch (...) {
    }
  });
  program.create("rg", {"ms"});
  CHECK_THROWS_AS(program.run(), DeviceRemoved);
}

namespace {
struct Chain {
  uint remaining, calls;
};

void make_chain(Program& program, const Buffer& log, uint length) {
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    Chain chain{length, 0};
    ctx.CallShader(0, chain);
    out[ctx.DispatchRaysIndex().x] = chain.calls;
  });
  program.shaders.Callable("ca", [](CallableContext& ctx, Chain& chain) {
    ++chain.calls;
    if (--chain.remaining) ctx.CallShader(chain.remaining % 2, chain);
  });
  program.create("rg", {}, {}, {"ca", "ca"});
}
}  // namespace

TEST_CASE("CA-01, CA-03, CA-04, RC-06: callables with recursion depth 0; the default stack holds two levels") {
  Program program(0);
  const Buffer log = program.counters();
  make_chain(program, log, 2);
  const DispatchReport report = program.run(40);
  CHECK(report.mode == ExecutionMode::direct);  // nothing traces
  CHECK(report.statistics.callable == 80);
  CHECK(log.as<uint>()[39] == 2);
}

TEST_CASE("CA-03, RC-05: ten nested callables need a larger pipeline stack, and have it") {
  for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
    Program program(0);
    const Buffer log = program.counters();
    make_chain(program, log, 10);
    const StateObject& object = *program.pipeline;
    object.SetPipelineStackSize(object.GetShaderStackSize("rg") + 10 * object.GetShaderStackSize("ca"));
    CHECK(program.run(40, 1, 1, in_mode(mode)).statistics.callable == 400);
    CHECK(log.as<uint>()[39] == 10);
    object.SetPipelineStackSize(object.GetPipelineStackSize() - 1);
    CHECK_THROWS_WITH(program.run(40, 1, 1, in_mode(mode)), Contains("RC-05"));
    CHECK_FALSE(program.device.GetDeviceRemovedReason().empty());
  }
}

TEST_CASE("SID-14, RC-09: the stack size counts when recorded, and absurd ones cannot be recorded") {
  Program program(0);
  const Buffer log = program.counters();
  make_chain(program, log, 2);
  CommandList list;
  list.SetPipelineState1(program.pipeline);
  program.dispatch.Width = program.dispatch.Height = program.dispatch.Depth = 1;
  list.DispatchRays(program.dispatch);
  program.pipeline->SetPipelineStackSize(1);
  CHECK_NOTHROW(program.device.execute(list));
  program.pipeline->SetPipelineStackSize(0xfffffffe);
  CHECK_THROWS_WITH(list.DispatchRays(program.dispatch), Contains("RC-09"));
}

TEST_CASE("RC-08: endless callables end in a clear error long before the host stack does") {
  for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
    Program program(0);
    const Buffer log = program.counters();
    make_chain(program, log, ~0u);
    program.pipeline->SetPipelineStackSize(200000);
    CHECK_THROWS_AS(program.run(3, 1, 1, in_mode(mode)), DeviceRemoved);
  }
  Program program(0);  // the declared sizes are far too small: the host stack is checked
  program.shaders.RayGeneration("rg", [](RayGenContext& ctx) {
    Chain chain{~0u, 0};
    ctx.CallShader(0, chain);
  });
  program.shaders.Callable("ca",
                           [](CallableContext& ctx, Chain& chain) {
                             volatile char frame[4000];
                             frame[chain.calls % 4000] = 1;
                             ++chain.calls;
                             ctx.CallShader(0, chain);
                             chain.calls += frame[1] & 0u;
                           },
                           {.stack_bytes = 1});
  program.create("rg", {}, {}, {"ca"});
  program.pipeline->SetPipelineStackSize(40000);
  CHECK_THROWS_WITH(program.run(3, 1, 1, in_mode(ExecutionMode::warp)), Contains("RC-08"));
}

TEST_CASE("CA-05: parameters of another type are refused and reported") {
  Program program(0);
  program.shaders.RayGeneration("rg", [](RayGenContext& ctx) {
    Value value{1};
    ctx.CallShader(0, value);
  });
  program.shaders.Callable("ca", [](CallableContext&, Chain&) {});
  program.create("rg", {}, {}, {"ca"});
  CHECK(program.run().statistics.callable == 0);
  CHECK(program.reported("CA-05"));
}
