// Rows ST: tables, indices, identifiers.

#include "program.h"

#include <rayloom/base/error.h>
#include <rayloom/runtime/shader_record.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;

namespace {

struct Id {
  uint id;
};

/// A pipeline whose hit groups all write the id of the record that selected them.
class IdProgram : public Program {
 public:
  IdProgram(uint instance_contribution, const std::vector<float>& zs, uint32_t hit_record_count = 64) {
    results = counters();
    RAYTRACING_INSTANCE_DESC desc_of_instance = instance(layers(zs));
    desc_of_instance.InstanceContributionToHitGroupIndex = instance_contribution & 0xFFFFFFu;
    scene_view = scene({desc_of_instance});
    arguments = counters(8);
    shaders.RayGeneration("rg", [scene = scene_view, out = results.rw_structured<uint>(),
                                 in = arguments.structured<uint>()](RayGenContext& ctx) {
      Value payload{~0u};
      ctx.TraceRay(scene, RAY_FLAG_NONE, 0xFF, in[0], in[1], in[2], straight_ray(in[3] ? 100.0f : 0.0f), payload);
      out[0] = payload.value;
    });
    shaders.ClosestHit("ch", [](ClosestHitContext& ctx, Value& payload, const Barycentrics&) {
      payload.value = ctx.LocalRoot<Id>().id;
    });
    shaders.Miss("ms", [](MissContext& ctx, Value& payload) { payload.value = 1000 + ctx.LocalRoot<Id>().id; });
    desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Struct<Id>()});
    const size_t none = desc.add(LOCAL_ROOT_SIGNATURE{RootSignature()});
    desc.add(SUBOBJECT_TO_EXPORTS_ASSOCIATION{none, {"rg"}});
    hit_group("hg", "ch");
    create("rg");
    ShaderTableBuilder hits(*pipeline), misses(*pipeline);
    for (uint i = 0; i < hit_record_count; ++i) hits.add("hg", Id{i});
    for (uint i = 0; i < 8; ++i) misses.add("ms", Id{i});
    tables.push_back(hits.build(device));
    dispatch.HitGroupTable = tables.back();
    tables.push_back(misses.build(device));
    dispatch.MissShaderTable = tables.back();
  }

  uint trace(uint ray_contribution, uint multiplier, uint miss_index = 0, bool miss = false) {
    arguments.upload(std::span<const uint>(std::vector<uint>{ray_contribution, multiplier, miss_index, miss}));
    run();
    return results.as<uint>()[0];
  }

  Buffer results, arguments;
  RaytracingAccelerationStructure scene_view;
};

}  // namespace

TEST_CASE("ST-12: the index function at its extremes") {
  using detail::hit_group_index;
  CHECK(hit_group_index(15, 15, (1u << 24) - 1, 0xFFFFFF) == 15 + 15 * uint64_t{(1u << 24) - 1} + 0xFFFFFF);
  CHECK(hit_group_index(15, 15, (1u << 24) - 1, 0xFFFFFF) == (uint64_t{1} << 28) - 1);
  CHECK(hit_group_index(0x10, 0x10, 5, 0x01000000) == 0);
  CHECK(hit_group_index(0x1F, 0x11, 5, 0xFF000003) == 15 + 5 + 3);
}

TEST_CASE("ST-07, ST-09, ST-11: ray, multiplier, geometry and instance sweep") {
  for (const uint contribution : {0u, 3u, 20u}) {
    for (const size_t geometry : {0u, 1u, 2u}) {
      std::vector<float> zs = {7, 8, 9};
      zs[geometry] = 1;
      IdProgram program(contribution, zs);
      for (const uint ray : {0u, 1u, 5u, 15u})
        for (const uint multiplier : {0u, 1u, 2u, 7u})
          CHECK(program.trace(ray, multiplier) == ray + multiplier * geometry + contribution);
      CHECK(program.messages.empty());
    }
  }
}

TEST_CASE("ST-08: high bits of contribution, multiplier and miss index are masked") {
  IdProgram program(3, {5, 1});
  CHECK(program.trace(0x10, 0) == 3);
  CHECK(program.trace(0x1F, 0) == 18);
  CHECK(program.trace(0xFFFFFFF2, 0) == 5);
  CHECK(program.trace(0, 0x12) == 5);
  CHECK(program.trace(0, 0x10) == 3);
  CHECK(program.trace(0, 0, 0x10002, true) == 1002);
  CHECK(program.trace(0, 0, 0xFFFF0007, true) == 1007);
}

TEST_CASE("ST-03: stride 0 selects the first record; ST-13: miss index") {
  IdProgram program(0, {1});
  CHECK(program.trace(0, 0, 5, true) == 1005);
  program.dispatch.MissShaderTable.StrideInBytes = 0;
  for (uint index = 0; index < 4; ++index) CHECK(program.trace(0, 0, index, true) == 1000);
  program.dispatch.HitGroupTable.StrideInBytes = 0;
  CHECK(program.trace(7, 0) == 0);
}

TEST_CASE("ST-07: every record of a long table names its own shader") {
  constexpr uint records = 1500;  // more than are looked up before the dispatch
  Program program;
  const Buffer log = program.counters(records);
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    const uint index = ctx.DispatchRaysIndex().x;
    Value payload{0};
    ctx.TraceRay({}, 0, 0xFF, 0, 0, index, straight_ray(), payload);
    out[index] = payload.value;
  });
  program.shaders.Miss("one", [](MissContext&, Value& payload) { payload.value = 1; });
  program.shaders.Miss("two", [](MissContext&, Value& payload) { payload.value = 2; });
  std::vector<std::string> names;
  for (uint i = 0; i < records; ++i) names.push_back(i % 3 == 0 ? "" : i % 3 == 1 ? "one" : "two");
  program.create("rg", names);
  program.run(records);
  uint wrong = 0;
  for (uint i = 0; i < records; ++i) wrong += log.as<uint>()[i] != i % 3;
  CHECK(wrong == 0);
  CHECK(program.messages.empty());
}

TEST_CASE("ST-04, ST-05: slack between records and garbage in unused ones") {
  IdProgram program(0, {1});
  Buffer table = program.device.create_buffer(4 * 128);
  std::fill(table.host().begin(), table.host().end(), std::byte{0xA5});
  for (uint i : {0u, 2u}) {
    table.upload(std::span<const std::byte>(*program.pipeline->GetShaderIdentifier("hg")), i * 128);
    table.upload(std::span<const uint>(std::vector<uint>{77 + i}), i * 128 + 32);
  }
  program.dispatch.HitGroupTable = {table.address(), table.bytes(), 128};
  CHECK(program.trace(0, 0) == 77);
  CHECK(program.trace(2, 0) == 79);
  CHECK(program.messages.empty());
}

TEST_CASE("ST-18: an index out of bounds is reported and counts as NULL") {
  IdProgram program(0, {1}, 4);
  CHECK(program.trace(3, 0) == 3);
  CHECK(program.messages.empty());
  CHECK(program.trace(4, 0) == ~0u);
  CHECK(program.reported("ST-18"));
  program.messages.clear();
  CHECK(program.trace(0, 0, 8, true) == ~0u);
  CHECK(program.reported("ST-18"));
  program.dispatch.HitGroupTable = {0, 0, 0};
  CHECK(program.trace(0, 0) == ~0u);
  program.dispatch.HitGroupTable = {DeviceMemory::first_address + (uint64_t{1} << 35), 4096, 32};  // not committed
  CHECK(program.trace(0, 0) == ~0u);
}

TEST_CASE("ST-19: identifiers of another state object and of another kind") {
  IdProgram program(0, {1});
  Program other;
  other.shaders.Miss("foreign", [](MissContext&, Value& payload) { payload.value = 5; });
  other.shaders.RayGeneration("rg", [](RayGenContext&) {});
  other.create("rg");
  Buffer table = program.device.create_buffer(64);
  table.upload(std::span<const std::byte>(*other.pipeline->GetShaderIdentifier("foreign")));
  program.dispatch.MissShaderTable = {table.address(), 64, 32};
  CHECK(program.trace(0, 0, 0, true) == ~0u);
  CHECK(program.reported("ST-19"));
  program.messages.clear();
  table.upload(std::span<const std::byte>(*program.pipeline->GetShaderIdentifier("hg")));
  CHECK(program.trace(0, 0, 0, true) == ~0u);  // a hit group is no miss shader
  CHECK(program.reported("ST-19"));
}

TEST_CASE("ST-14: a NULL hit record commits, hides what is behind it, and runs nothing") {
  for (const auto flags : {RAYTRACING_GEOMETRY_FLAG_OPAQUE, RAYTRACING_GEOMETRY_FLAG_NONE}) {
    Program program;
    const Buffer log = program.counters();
    program.shaders.RayGeneration("rg", [scene = program.scene(program.layers({1, 2}, {flags})),
                                         out = log.rw_structured<uint>()](RayGenContext& ctx) {
      Value payload{7};
      ctx.TraceRay(scene, 0, 0xFF, 0, 1, 0, straight_ray(), payload);
      out[0] = payload.value;
    });
    program.shaders.ClosestHit("ch",
                               [](ClosestHitContext&, Value& payload, const Barycentrics&) { payload.value = 8; });
    program.shaders.AnyHit("ah", [](AnyHitContext& ctx, Value&, const Barycentrics&) { return ctx.IgnoreHit(); });
    program.shaders.Miss("ms", [](MissContext&, Value& payload) { payload.value = 9; });
    program.hit_group("hg", "ch", "ah");
    program.create("rg", {"ms"}, {"", "hg"});
    const DispatchReport report = program.run();
    CHECK(log.as<uint>()[0] == 7);
    CHECK(report.statistics.hits == 1);
    CHECK(report.statistics.closest_hit + report.statistics.miss == 0);
    CHECK(program.messages.empty());
  }
}

TEST_CASE("ST-15: NULL miss and callable records run nothing") {
  Program program;
  const Buffer log = program.counters();
  program.shaders.RayGeneration("rg", [out = log.rw_structured<uint>()](RayGenContext& ctx) {
    Value payload{7}, parameters{8};
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    ctx.CallShader(0, parameters);
    out[0] = payload.value;
    out[1] = parameters.value;
  });
  program.create("rg", {""}, {}, {""});
  program.run();
  CHECK(log.as<uint>()[0] == 7);
  CHECK(log.as<uint>()[1] == 8);
  CHECK(program.messages.empty());
}

TEST_CASE("ST-16, ST-20: procedural geometry under NULL and triangle records is not hit") {
  for (const std::string record : {"", "triangles"}) {
    Program program;
    const Buffer log = program.counters();
    program.shaders.RayGeneration(
        "rg", [scene = program.scene(program.boxes({1})), out = log.rw_structured<uint>()](RayGenContext& ctx) {
          Value payload{7};
          ctx.TraceRay(scene, 0, 0xFF, 0, 1, 0, straight_ray(), payload);
          out[0] = payload.value;
        });
    program.shaders.Intersection("is", [](IntersectionContext& ctx) { return ctx.ReportHit(2.0f, 0, NoPayload{}); });
    program.shaders.ClosestHit("ch",
                               [](ClosestHitContext&, Value& payload, const Barycentrics&) { payload.value = 8; });
    program.shaders.Miss("ms", [](MissContext&, Value& payload) { payload.value = 9; });
    program.hit_group("triangles", "ch").hit_group("procedural", "", "", "is");
    program.create("rg", {"ms"}, {record});
    program.run();
    CHECK(log.as<uint>()[0] == 9);
    CHECK(program.reported("ST-20") == !record.empty());
  }
}

TEST_CASE("ST-20: triangles under a procedural record run no shader") {
  for (const auto flags : {RAYTRACING_GEOMETRY_FLAG_OPAQUE, RAYTRACING_GEOMETRY_FLAG_NONE}) {
    Program program;
    const auto scene = program.scene(program.layers({1}, {flags}));
    program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
      Value payload{7};
      ctx.TraceRay(scene, 0, 0xFF, 0, 1, 0, straight_ray(), payload);
    });
    program.shaders.Intersection("is", [](IntersectionContext& ctx) { return ctx.ReportHit(2.0f, 0, Barycentrics{}); });
    program.shaders.ClosestHit("ch", [](ClosestHitContext&, Value&, const Barycentrics&) {});
    program.shaders.AnyHit("ah", [](AnyHitContext& ctx, Value&, const Barycentrics&) { return ctx.AcceptHit(); });
    program.hit_group("procedural", "ch", "ah", "is");
    program.create("rg", {""}, {"procedural"});
    const DispatchStatistics statistics = program.run().statistics;
    CHECK(statistics.closest_hit + statistics.any_hit + statistics.intersection == 0);
    CHECK(program.reported("ST-20"));
  }
}

TEST_CASE("the typed writer: strides, alignments and refusals") {
  IdProgram program(0, {1});
  struct Large {
    uint words[10];
  };
  ShaderTableBuilder builder(*program.pipeline);
  CHECK_THROWS_AS(builder.add("nobody"), InputError);
  CHECK_THROWS_AS(builder.add("hg"), InputError);
  CHECK_THROWS_AS(builder.add("hg", Large{}), InputError);
  CHECK(builder.count() == 0);
  const ShaderTable table = builder.add("hg", Id{1}).add_null().build(program.device);
  CHECK(table.stride() == 64);
  CHECK(table.count() == 2);
  CHECK(table.address() % 64 == 0);
}
