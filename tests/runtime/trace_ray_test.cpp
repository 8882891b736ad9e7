// Rows TR, RF, OP, AH, CM, PL: what TraceRay runs, and in what order.

#include "program.h"
#include "reference_tracer.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace rayloom;
using namespace rayloom::test;

namespace {

enum Slot : uint { any_hits, closest_hits, misses, intersections, payload_slot, slots = 16 };

/// Counts which stages ran, for one ray with given flags through a given scene.
class CountingProgram : public Program {
 public:
  explicit CountingProgram(bool with_any_hit = true) {
    log = counters(slots);
    arguments = counters(4);
    const auto out = log.rw_structured<uint>();
    shaders.RayGeneration("rg", [this_scene = &scene_view, in = arguments.structured<uint>(), out](RayGenContext& ctx) {
      Value payload{0};
      ctx.TraceRay(*this_scene, in[0], in[1], 0, 0, 0, straight_ray(), payload);
      out[payload_slot] = payload.value;
    });
    shaders.AnyHit("ah", [out](AnyHitContext& ctx, Value& payload, const Barycentrics&) {
      InterlockedAdd(out[any_hits], 1);
      payload.value += 1;
      return ctx.AcceptHit();
    });
    shaders.AnyHit("procedural_ah", [out](AnyHitContext& ctx, Value&, const Value&) {
      InterlockedAdd(out[any_hits], 1);
      return ctx.AcceptHit();
    });
    shaders.ClosestHit("ch", [out](ClosestHitContext&, Value& payload, const Barycentrics&) {
      InterlockedAdd(out[closest_hits], 1);
      payload.value += 100;
    });
    shaders.ClosestHit("procedural_ch",
                       [out](ClosestHitContext&, Value&, const Value&) { InterlockedAdd(out[closest_hits], 1); });
    shaders.Intersection("is", [out](IntersectionContext& ctx) {
      InterlockedAdd(out[intersections], 1);
      return ctx.ReportHit(2.5f, 3, Value{});
    });
    shaders.Miss("ms", [out](MissContext&, Value& payload) {
      InterlockedAdd(out[misses], 1);
      payload.value += 10000;
    });
    hit_group("triangles", "ch", with_any_hit ? "ah" : "");
    hit_group("boxes", "procedural_ch", with_any_hit ? "procedural_ah" : "", "is");
  }

  std::vector<uint> trace(uint flags, uint mask = 0xFF) {
    arguments.upload(std::span<const uint>(std::vector<uint>{flags, mask}));
    log.upload(std::span<const uint>(std::vector<uint>(slots)));
    messages.clear();
    statistics = run().statistics;
    return log.download<uint>(5);
  }

  Buffer log, arguments;
  RaytracingAccelerationStructure scene_view;
  DispatchStatistics statistics;
};

std::vector<uint> outcome(uint any_hit, uint closest_hit, uint miss, uint intersection, uint payload) {
  return {any_hit, closest_hit, miss, intersection, payload};
}

}  // namespace

TEST_CASE("OP-01..OP-11: opacity of geometry, instance and ray, for triangles and boxes, with and without any-hit") {
  // Rows: base opaque x instance flag; columns: ray flags. H hit, A any-hit decides, C culled.
  const std::vector<std::string> expected = {"HHACH", "HHACH", "AHAAC", "AHAAC", "HHACH", "AHAAC"};
  const uint ray_flags[] = {RAY_FLAG_NONE, RAY_FLAG_FORCE_OPAQUE, RAY_FLAG_FORCE_NON_OPAQUE, RAY_FLAG_CULL_OPAQUE,
                            RAY_FLAG_CULL_NON_OPAQUE};
  const uint instance_flags[] = {RAYTRACING_INSTANCE_FLAG_NONE, RAYTRACING_INSTANCE_FLAG_FORCE_OPAQUE,
                                 RAYTRACING_INSTANCE_FLAG_FORCE_NON_OPAQUE};
  for (const bool with_any_hit : {true, false})
    for (const bool boxes : {false, true}) {
      CountingProgram program(with_any_hit);
      program.create("rg", {"ms"}, {boxes ? "boxes" : "triangles"});
      for (uint row = 0; row < 6; ++row) {
        const auto flags = row < 3 ? RAYTRACING_GEOMETRY_FLAG_OPAQUE : RAYTRACING_GEOMETRY_FLAG_NONE;
        RAYTRACING_INSTANCE_DESC desc = instance(boxes ? program.boxes({1}, flags) : program.layers({1}, {flags}));
        desc.Flags = instance_flags[row % 3] & 0xFFu;
        program.scene_view = program.scene({desc});
        for (uint column = 0; column < 5; ++column) {
          const char cell = expected[row][column];
          CAPTURE(with_any_hit, boxes, row, column, cell);
          const bool hit = cell != 'C', asked = cell == 'A' && with_any_hit;
          const uint payload = boxes ? (hit ? 0 : 10000) : (hit ? 100 + asked : 10000);
          CHECK(program.trace(ray_flags[column]) == outcome(asked, hit, !hit, boxes && hit, payload));
        }
      }
    }
}

TEST_CASE("RF-02..RF-09, RF-13..RF-15: flags over a triangle, a back face and a box") {
  struct Case {
    uint flags;
    std::vector<uint> front, back, box;
  };
  const auto nothing = outcome(0, 0, 1, 0, 10000), opaque = outcome(0, 1, 0, 0, 100), asked = outcome(1, 1, 0, 0, 101);
  const auto box_asked = outcome(1, 1, 0, 1, 0), box_opaque = outcome(0, 1, 0, 1, 0);
  const Case cases[] = {
      {RAY_FLAG_NONE, asked, asked, box_asked},
      {RAY_FLAG_FORCE_OPAQUE, opaque, opaque, box_opaque},
      {RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH, asked, asked, box_asked},
      {RAY_FLAG_SKIP_CLOSEST_HIT_SHADER, outcome(1, 0, 0, 0, 1), outcome(1, 0, 0, 0, 1), outcome(1, 0, 0, 1, 0)},
      {RAY_FLAG_CULL_BACK_FACING_TRIANGLES, asked, nothing, box_asked},
      {RAY_FLAG_CULL_FRONT_FACING_TRIANGLES, nothing, asked, box_asked},
      {RAY_FLAG_CULL_NON_OPAQUE, nothing, nothing, nothing},
      {RAY_FLAG_SKIP_TRIANGLES, nothing, nothing, box_asked},
      {RAY_FLAG_SKIP_PROCEDURAL_PRIMITIVES, asked, asked, nothing},
  };
  CountingProgram program;
  program.create("rg", {"ms"}, {"triangles", "boxes"});
  const AccelerationStructure& triangle = program.layers({1}, {RAYTRACING_GEOMETRY_FLAG_NONE});
  RAYTRACING_INSTANCE_DESC turned = instance(triangle);
  turned.Flags = RAYTRACING_INSTANCE_FLAG_TRIANGLE_FRONT_COUNTERCLOCKWISE;
  RAYTRACING_INSTANCE_DESC box = instance(program.boxes({1}, RAYTRACING_GEOMETRY_FLAG_NONE));
  box.InstanceContributionToHitGroupIndex = 1;
  const RaytracingAccelerationStructure scenes[] = {program.scene(triangle), program.scene({turned}),
                                                    program.scene({box})};
  for (const Case& item : cases) {
    CAPTURE(item.flags);
    program.scene_view = scenes[0];
    CHECK(program.trace(item.flags) == item.front);
    program.scene_view = scenes[1];
    CHECK(program.trace(item.flags) == item.back);
    program.scene_view = scenes[2];
    CHECK(program.trace(item.flags) == item.box);
    CHECK(program.messages.empty());
  }
}

TEST_CASE("TR-03, RS-12, TR-21: a null structure and an empty one miss") {
  CountingProgram program;
  program.create("rg", {"ms"}, {"triangles"});
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  program.scene_view = program.scene(std::vector<RAYTRACING_INSTANCE_DESC>{});
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  program.scene_view = program.scene(std::vector<RAYTRACING_INSTANCE_DESC>(3));
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  CHECK(program.messages.empty());
}

TEST_CASE("TL-11, TL-12: what is no top level any more misses and is reported") {
  CountingProgram program;
  program.create("rg", {"ms"}, {"triangles"});
  const AccelerationStructure& triangle = program.layers({1});
  program.scene_view = triangle.view();
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  CHECK(program.reported("TL-12"));
  program.scene_view = {program.log.address()};
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  CHECK(program.reported("TL-12"));
  program.scene_view = {0x1234};
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  CHECK(program.reported("TL-12"));
  program.scene_view = program.scene(triangle);
  *program.structures[0] = AccelerationStructure();  // the bottom level is freed
  CHECK(program.trace(0) == outcome(0, 0, 1, 0, 10000));
  CHECK(program.reported("TL-11"));
}

TEST_CASE("TR-11, TR-12: instance masks") {
  CountingProgram program;
  program.create("rg", {"ms"}, {"triangles"});
  RAYTRACING_INSTANCE_DESC desc = instance(program.layers({1}));
  desc.InstanceMask = 0x81;
  program.scene_view = program.scene({desc});
  for (const uint mask : {0x01u, 0x80u, 0xFFu, 0xFFFFFFFFu}) CHECK(program.trace(0, mask)[closest_hits] == 1);
  for (const uint mask : {0x00u, 0x7Eu, 0x100u, 0xFFFFFF00u}) CHECK(program.trace(0, mask)[misses] == 1);
  desc.InstanceMask = 0;
  program.scene_view = program.scene({desc});
  CHECK(program.trace(0, 0xFF)[misses] == 1);
}

TEST_CASE("SO-12: a hit group without shaders is an opaque no-op") {
  CountingProgram program;
  program.hit_group("empty", "");
  program.create("rg", {"ms"}, {"empty"});
  program.scene_view = program.scene(program.layers({1}, {RAYTRACING_GEOMETRY_FLAG_NONE}));
  CHECK(program.trace(0) == outcome(0, 0, 0, 0, 0));
  CHECK(program.statistics.hits == 1);
}

TEST_CASE("ST-17: SKIP_CLOSEST_HIT over opaque geometry needs no hit group table") {
  CountingProgram program;
  program.create("rg", {"ms"});
  program.scene_view = program.scene(program.layers({1}));
  CHECK(program.trace(RAY_FLAG_SKIP_CLOSEST_HIT_SHADER) == outcome(0, 0, 0, 0, 0));
  CHECK(program.messages.empty());
}

namespace {

/// Any-hit does what the geometry's index tells it: 0 accept, 1 ignore, 2 accept and end.
DispatchStatistics run_layers(Program& program, const std::vector<float>& zs, uint flags, Buffer& log, Tracer* tracer) {
  const auto scene = program.scene(program.layers(zs, {RAYTRACING_GEOMETRY_FLAG_NONE}));
  log = program.counters();
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    Value payload{1};
    ctx.TraceRay(scene, flags, 0xFF, 0, 0, 0, straight_ray(), payload);
    out[0] = payload.value;
  });
  program.shaders.AnyHit("ah", [out](AnyHitContext& ctx, Value& payload, const Barycentrics&) {
    payload.value *= 3;
    InterlockedAdd(out[10 + ctx.GeometryIndex()], 1);
    if (ctx.GeometryIndex() == 1) return ctx.IgnoreHit();
    return ctx.GeometryIndex() == 2 ? ctx.AcceptHitAndEndSearch() : ctx.AcceptHit();
  });
  program.shaders.ClosestHit("ch", [out](ClosestHitContext& ctx, Value& payload, const Barycentrics&) {
    out[1] = 1 + ctx.GeometryIndex();
    payload.value += 1;
  });
  program.shaders.Miss("ms", [](MissContext&, Value& payload) { payload.value += 1000; });
  program.hit_group("hg", "ch", "ah");
  program.create("rg", {"ms"}, {"hg"});
  DispatchOptions options;
  options.tracer = tracer;
  return program.run(1, 1, 1, options).statistics;
}

}  // namespace

TEST_CASE("AH-02..AH-05, AH-13, CM-04, CM-05: any-hit decisions") {
  ReferenceTracer reference;
  for (Tracer* tracer : {static_cast<Tracer*>(nullptr), static_cast<Tracer*>(&reference)}) {
    Buffer log;
    {
      Program program;  // accepted in front, ignored behind
      CHECK(run_layers(program, {1, 2}, 0, log, tracer).hits == 1);
      CHECK(log.as<uint>()[1] == 1);
      CHECK(log.as<uint>()[10] == 1);
    }
    {
      Program program;  // ignored in front: the one behind is hit, both any-hits ran, payload shows it
      CHECK(run_layers(program, {2, 1}, 0, log, tracer).any_hit == 2);
      CHECK(log.as<uint>()[1] == 1);
      CHECK(log.as<uint>()[0] == 1 * 3 * 3 + 1);
    }
    {
      Program program;  // all ignored: the miss shader sees the payload any-hit left
      const DispatchStatistics statistics = run_layers(program, {200, 1}, 0, log, tracer);
      CHECK(statistics.miss == 1);
      CHECK(statistics.hits == 0);
      CHECK(log.as<uint>()[0] == 1 * 3 + 1000);
    }
    {
      Program program;  // RF-05: ignoring under ACCEPT_FIRST_HIT lets the search go on
      const auto flags = RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH;
      CHECK(run_layers(program, {2, 1}, flags, log, tracer).hits == 1);
      CHECK(log.as<uint>()[1] == 1);
    }
  }
}

TEST_CASE("TR-13, AH-04: AcceptHitAndEndSearch stops the search with the hit in hand") {
  Program program;
  Buffer log;
  // Two coplanar-free layers: whichever is met first, an accepted end leaves at most one more any-hit.
  const DispatchStatistics statistics = run_layers(program, {90, 95, 1}, 0, log, nullptr);
  CHECK(statistics.hits == 1);
  CHECK(log.as<uint>()[12] == 1);
  CHECK(log.as<uint>()[1] == 3);
  CHECK(statistics.closest_hit == 1);
}

TEST_CASE("RF-04: ACCEPT_FIRST_HIT commits exactly one") {
  Program program;
  Buffer log;
  const DispatchStatistics statistics =
      run_layers(program, {1}, RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH, log, nullptr);
  CHECK(statistics.any_hit == 1);
  CHECK(statistics.closest_hit == 1);
}

TEST_CASE("TR-07: any-hit only for hits closer than the committed one") {
  Program program;
  const Buffer log = program.counters();
  const auto out = log.rw_structured<uint>();
  const auto scene =
      program.scene(program.layers({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {RAYTRACING_GEOMETRY_FLAG_NONE}));
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    Value payload{1000};
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.AnyHit("ah", [out](AnyHitContext& ctx, Value& payload, const Barycentrics&) {
    const uint t = uint(ctx.RayTCurrent());
    if (t >= payload.value) InterlockedAdd(out[1], 1);
    payload.value = t;
    InterlockedAdd(out[0], 1);
    return ctx.AcceptHit();
  });
  program.hit_group("hg", "", "ah");
  program.create("rg", {""}, {"hg"});
  program.run();
  CHECK(log.as<uint>()[0] >= 1);
  CHECK(log.as<uint>()[1] == 0);
}

TEST_CASE("TR-14, TR-20: the ray description is untouched; many traces in one shader") {
  Program program;
  const Buffer log = program.counters();
  const auto out = log.rw_structured<uint>();
  const auto scene = program.scene(program.layers({1}));
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    const RayDesc ray = straight_ray(), copy = ray;
    Value payload{0};
    for (uint i = 0; i < 100 + ctx.DispatchRaysIndex().x; ++i) ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, ray, payload);
    out[ctx.DispatchRaysIndex().x] = payload.value + (std::memcmp(&ray, &copy, sizeof(ray)) == 0 ? 0 : 5000);
  });
  program.shaders.ClosestHit("ch", [](ClosestHitContext&, Value& payload, const Barycentrics&) { ++payload.value; });
  program.hit_group("hg", "ch");
  program.create("rg", {""}, {"hg"});
  CHECK(program.run(40).statistics.rays == 40 * 100 + 39 * 20);
  for (uint i = 0; i < 40; ++i) CHECK(log.as<uint>()[i] == 100 + i);
}

TEST_CASE("EXT-01, EXT-05, TR-19, TR-17, TR-18: extents, infinities and rays that miss") {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    RayDesc ray;
    bool hit;
    const char* row;
  };
  const float3 o(0, 0, 0), d(0, 0, 1);  // the triangle is at t = 1
  const std::vector<Case> cases = {
      {{o, 0, d, infinity}, true, ""},
      {{o, 1, d, 2}, false, ""},
      {{o, 0, d, 1}, false, ""},
      {{o, 0.5f, d, 1.0000001f}, true, ""},
      {{o, 1, d, 1}, false, ""},
      {{o, infinity, d, infinity}, false, ""},
      {{o, 0, d * 2.0f, 0.75f}, true, ""},
      {{o, -1, d, 2}, false, "TR-17"},
      {{o, 3, d, 2}, false, "TR-17"},
      {{float3(nan, 0, 0), 0, d, 2}, false, "TR-17"},
      {{o, nan, d, 2}, false, "TR-17"},
      {{o, 0, d, nan}, false, "TR-17"},
      {{o, 0, float3(0, nan, 1), 2}, false, "TR-17"},
      {{o, 0, float3(0), 2}, false, "TR-18"},
      {{o, 0, float3(0, 0, infinity), 2}, false, "TR-18"},
      {{float3(-infinity, 0, 0), 0, d, 2}, false, "TR-18"},
  };
  Program program;
  const auto scene = program.scene(program.layers({1}));
  const Buffer rays = program.device.create_buffer(sizeof(RayDesc));
  program.shaders.RayGeneration("rg", [scene, ray = rays.structured<RayDesc>()](RayGenContext& ctx) {
    NoPayload payload;
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, ray[0], payload);
  });
  program.shaders.Miss("ms", [](MissContext&, NoPayload&) {});
  program.shaders.ClosestHit("ch", [](ClosestHitContext&, NoPayload&, const Barycentrics&) {});
  program.hit_group("hg", "ch");
  program.create("rg", {"ms"}, {"hg"});
  ReferenceTracer reference;
  for (size_t i = 0; i < cases.size(); ++i) {
    CAPTURE(i);
    rays.upload(std::span<const RayDesc>(&cases[i].ray, 1));
    for (Tracer* tracer : {static_cast<Tracer*>(nullptr), static_cast<Tracer*>(&reference)}) {
      program.messages.clear();
      DispatchOptions options;
      options.tracer = tracer;
      const DispatchStatistics statistics = program.run(1, 1, 1, options).statistics;
      CHECK(statistics.closest_hit == cases[i].hit);
      CHECK(statistics.miss == !cases[i].hit);
      if (*cases[i].row)
        CHECK(program.reported(cases[i].row));
      else
        CHECK(program.messages.empty());
    }
  }
}

TEST_CASE("RF-10, RF-12, RF-14, RF-17, RF-18: flags that exclude each other, and undefined ones") {
  CountingProgram program;
  program.create("rg", {"ms"}, {"triangles"});
  program.scene_view = program.scene(program.layers({1}));
  program.trace(0x30);
  CHECK(program.reported("RF-10"));
  const uint opacity[] = {0x1, 0x2, 0x40, 0x80};
  for (const uint a : opacity)
    for (const uint b : opacity) {
      program.trace(a | b);
      CHECK(program.reported("RF-12") == (a != b));
    }
  for (const uint flags : {0x110u, 0x120u, 0x300u}) {
    program.trace(flags);
    CHECK(program.reported("RF-14"));
  }
  program.trace(0xFFFFFC00);
  CHECK(program.reported("RF-17"));
  CHECK(program.log.as<uint>()[closest_hits] == 1);
}

namespace {
struct Radiance {
  float4 color;
};
struct Shadow {
  uint visible;
};
}  // namespace

TEST_CASE("PL-03, PL-04, STG-13: payload types") {
  Program program;
  const Buffer log = program.counters();
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [out](RayGenContext& ctx) {
    Radiance radiance{};
    Shadow shadow{0};
    NoPayload none;
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), radiance);
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 1, straight_ray(), shadow);
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 2, straight_ray(), none);
    out[0] = uint(radiance.color.x);
    out[1] = shadow.visible;
  });
  program.shaders.Miss("radiance", [](MissContext&, Radiance& payload) { payload.color.x = 5; });
  program.shaders.Miss("shadow", [](MissContext&, Shadow& payload) { payload.visible = 1; });
  program.shaders.Miss("empty", [out](MissContext&, NoPayload&) { out[2] = 3; });
  program.create("rg", {"radiance", "shadow", "empty"});
  program.run();
  CHECK(log.download<uint>(3) == std::vector<uint>{5, 1, 3});
  CHECK(program.messages.empty());
  program.tables.push_back(program.table({"shadow", "shadow", "empty"}));
  program.dispatch.MissShaderTable = program.tables.back();
  CHECK(program.run().statistics.miss == 2);
  CHECK(log.as<uint>()[0] == 0);
  CHECK(program.reported("STG-13"));
}
