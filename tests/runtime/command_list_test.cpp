// Rows DR, ST-06, RS, BI, PB: what is read when a command is recorded, and what when it executes.

#include "program.h"

#include <rayloom/base/error.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;
using Catch::Matchers::Contains;

namespace {

struct Args {
  uint value;
  RWStructuredBuffer<uint> out;
};

/// Ray generation copies its local root constant to a buffer named by its record.
class CopyProgram : public Program {
 public:
  CopyProgram() : Program(0) {
    log = counters();
    shaders.RayGeneration("rg",
                          [](RayGenContext& ctx) {
                            const Args args = ctx.LocalRoot<Args>();
                            InterlockedAdd(args.out[0], args.value);
                            InterlockedAdd(args.out[1], 1);
                          },
                          {.local_root = root_type<Args>()});
    desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Struct<Args>()});
    desc.add(DXIL_LIBRARY_DESC{shaders});
    desc.add(shader_config);
    desc.add(config);
    pipeline = device.CreateStateObject(desc);
    record = ShaderTableBuilder(*pipeline).add("rg", Args{3, log.rw_structured<uint>()}).build(device);
    dispatch.RayGenerationShaderRecord = record;
    dispatch.Width = dispatch.Height = dispatch.Depth = 1;
  }

  Buffer log;
  ShaderTable record;
};

}  // namespace

TEST_CASE("DR-12, RS-02: the ray generation record carries local root arguments") {
  CopyProgram program;
  program.run(5, 2, 3);
  CHECK(program.log.as<uint>()[0] == 3 * 30);
}

TEST_CASE("DR-02: a zero dimension runs nothing") {
  CopyProgram program;
  for (const uint3 size : {uint3(0, 8, 8), uint3(8, 0, 8), uint3(8, 8, 0)}) {
    const DispatchReport report = program.run(size.x, size.y, size.z);
    CHECK(report.skipped_by == "DR-02");
    CHECK(report.statistics == DispatchStatistics{});
  }
  CHECK(program.log.as<uint>()[1] == 0);
  CHECK(program.messages.empty());
}

TEST_CASE("DR-03: more than 2^30 threads are skipped and reported, wrapping products included") {
  CopyProgram program;
  for (const uint3 size : {uint3(1u << 30, 2, 1), uint3(1u << 16, 1u << 16, 1), uint3(1u << 20, 1u << 20, 1u << 24),
                           uint3(0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF)}) {
    program.messages.clear();
    CHECK(program.run(size.x, size.y, size.z).skipped_by == "DR-03");
    CHECK(program.reported("DR-03"));
  }
  CHECK(program.log.as<uint>()[1] == 0);
}

TEST_CASE("DR-06: a dispatch without a pipeline is skipped and reported") {
  CopyProgram program;
  CommandList list;
  list.DispatchRays(program.dispatch);
  CHECK(program.device.execute(list).dispatches.at(0).skipped_by == "DR-06");
  CHECK(program.reported("DR-06"));
}

TEST_CASE("ST-02: alignments and strides of tables") {
  CopyProgram program;
  const auto refused = [&](DISPATCH_RAYS_DESC desc) {
    program.messages.clear();
    program.dispatch = desc;
    return program.run().skipped_by == "ST-02" && program.reported("ST-02");
  };
  const DISPATCH_RAYS_DESC good = program.dispatch;
  DISPATCH_RAYS_DESC bad = good;
  bad.RayGenerationShaderRecord.StartAddress += 32;
  CHECK(refused(bad));
  for (const auto table : {&DISPATCH_RAYS_DESC::MissShaderTable, &DISPATCH_RAYS_DESC::HitGroupTable,
                           &DISPATCH_RAYS_DESC::CallableShaderTable}) {
    (bad = good).*table = {good.RayGenerationShaderRecord.StartAddress + 32, 64, 32};
    CHECK(refused(bad));
    (bad = good).*table = {good.RayGenerationShaderRecord.StartAddress, 64, 16};
    CHECK(refused(bad));
    (bad = good).*table = {good.RayGenerationShaderRecord.StartAddress, 8192, 4128};
    CHECK(refused(bad));
    (bad = good).*table = {good.RayGenerationShaderRecord.StartAddress, 8192, 4096};
    CHECK_FALSE(refused(bad));
  }
}

TEST_CASE("ST-06, DR-08: a table may be written by an earlier command") {
  CopyProgram program;
  const ShaderTable source = ShaderTableBuilder(*program.pipeline)
                                 .add("rg", Args{40, program.log.rw_structured<uint>()})
                                 .build(program.device);
  const uint value = 500;
  CommandList list;
  list.SetPipelineState1(program.pipeline);
  list.DispatchRays(program.dispatch);
  list.CopyBufferRegion(program.record.buffer(), 0, source.buffer(), 0, source.buffer().bytes());
  list.DispatchRays(program.dispatch);
  list.WriteBuffer(program.record.buffer(), 32, std::as_bytes(std::span(&value, 1)));
  list.DispatchRays(program.dispatch);
  list.FillBuffer(program.record.buffer(), 32, 4, 6000);
  list.DispatchRays(program.dispatch);
  CHECK(program.log.as<uint>()[0] == 0);  // nothing runs before it is executed
  CHECK(program.device.execute(list).dispatches.size() == 4);
  CHECK(program.log.as<uint>()[0] == 3 + 40 + 500 + 6000);
}

TEST_CASE("DR-08: host descs are copied when recorded, device memory is read when executed") {
  Program program;
  const Buffer vertices = program.device.upload(std::vector<float3>{{-8, -8, 1}, {0, 8, 1}, {8, -8, 1}});
  RAYTRACING_GEOMETRY_DESC geometry = triangle_geometry(vertices, 3);
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
  inputs.Type = RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL;
  inputs.NumDescs = 1;
  inputs.pGeometryDescs = &geometry;
  const Buffer result = program.device.create_buffer(
      program.device.GetRaytracingAccelerationStructurePrebuildInfo(inputs).ResultDataMaxSizeInBytes);
  CommandList list;
  list.BuildRaytracingAccelerationStructure({result.address(), inputs});
  geometry = {};
  for (float3& vertex : vertices.as<float3>()) vertex.z = 6;
  program.device.execute(list);

  RAYTRACING_INSTANCE_DESC desc = instance(AccelerationStructure());
  desc.AccelerationStructure = result.address();
  const auto scene = program.scene({desc});
  const Buffer log = program.counters();
  program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
    Value payload{0};
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.ClosestHit("ch",
                             [out = log.rw_structured<uint>()](ClosestHitContext& ctx, Value&, const Barycentrics&) {
                               out[0] = uint(ctx.RayTCurrent());
                             });
  program.hit_group("hg", "ch");
  program.create("rg", {""}, {"hg"});
  program.run();
  CHECK(log.as<uint>()[0] == 7);
}

namespace {

struct GlobalArguments {
  uint value;
  RWStructuredBuffer<uint> out;
};
struct LocalArguments {
  uint value;
};

/// A shader of every stage that writes the sum of its global and local argument to a slot of its own.
void add_summing_shaders(Program& program, RaytracingAccelerationStructure scene) {
  const auto note = [](const auto& ctx, uint slot) {
    const GlobalArguments global = ctx.template GlobalRoot<GlobalArguments>();
    global.out[slot] = global.value + ctx.template LocalRoot<LocalArguments>().value;
  };
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    note(ctx, 0);
    Value payload;
    ctx.TraceRay(scene, RAY_FLAG_SKIP_TRIANGLES, 0xFF, 0, 0, 0, straight_ray(), payload);
    ctx.TraceRay(scene, RAY_FLAG_SKIP_PROCEDURAL_PRIMITIVES, 0xFF, 0, 0, 0, straight_ray(), payload);
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    ctx.CallShader(0, payload);
  });
  program.shaders.Intersection("is", [=](IntersectionContext& ctx) {
    note(ctx, 1);
    return ctx.EndIntersection();
  });
  program.shaders.AnyHit("ah", [=](AnyHitContext& ctx, Value&, const Barycentrics&) {
    note(ctx, 2);
    return ctx.AcceptHit();
  });
  program.shaders.ClosestHit("ch", [=](ClosestHitContext& ctx, Value&, const Barycentrics&) { note(ctx, 3); });
  program.shaders.Miss("ms", [=](MissContext& ctx, Value&) { note(ctx, 4); });
  program.shaders.Callable("ca", [=](CallableContext& ctx, Value&) { note(ctx, 5); });
  program.hit_group("hg", "ch", "ah").hit_group("box", "", "", "is");
}

void create_with_roots(Program& program) {
  program.desc.add(GLOBAL_ROOT_SIGNATURE{RootSignature().Struct<GlobalArguments>()});
  program.desc.add(LOCAL_ROOT_SIGNATURE{RootSignature().Struct<LocalArguments>()});
  program.desc.add(DXIL_LIBRARY_DESC{program.shaders});
  program.desc.add(program.shader_config);
  program.desc.add(program.config);
  program.pipeline = program.device.CreateStateObject(program.desc);
}

}  // namespace

TEST_CASE("RS-01, RS-03: global and local root arguments in every stage") {
  Program program;
  const Buffer log = program.counters();
  auto boxes = instance(program.boxes({3}));
  boxes.InstanceContributionToHitGroupIndex = 1;
  add_summing_shaders(program, program.scene({instance(program.layers({1}, {RAYTRACING_GEOMETRY_FLAG_NONE})), boxes}));
  create_with_roots(program);
  const auto table = [&](std::vector<std::pair<const char*, uint>> records) {
    ShaderTableBuilder builder(*program.pipeline);
    for (const auto& [name, value] : records) builder.add(name, LocalArguments{value});
    return builder.build(program.device);
  };
  const ShaderTable ray_generation = table({{"rg", 1}}), miss = table({{"ms", 5}}),
                    hit = table({{"hg", 3}, {"box", 2}}), callable = table({{"ca", 6}});
  CommandList list;
  list.SetPipelineState1(program.pipeline);
  list.SetComputeRoot(GlobalArguments{100, log.rw_structured<uint>()});
  list.DispatchRays({ray_generation, miss, hit, callable, 1, 1, 1});
  list.SetComputeRoot(GlobalArguments{0, {}});  // what was recorded stays
  program.device.execute(list);
  CHECK(log.download<uint>(6) == std::vector<uint>{101, 102, 103, 103, 105, 106});
  CHECK(program.messages.empty());
  CommandList bare;
  bare.SetPipelineState1(program.pipeline);
  bare.DispatchRays({ray_generation, miss, hit, callable, 1, 1, 1});
  program.device.execute(bare);
  CHECK(program.reported("RS-15"));
}

TEST_CASE("root arguments set one by one lie as RS-04 says") {
  struct Global {
    uint a, padding;
    uint64_t view;
    uint b, c;
  };
  Program program(0);
  const Buffer log = program.counters();
  program.shaders.RayGeneration("rg", [out = log.rw_structured<uint>()](RayGenContext& ctx) {
    const Global global = ctx.GlobalRoot<Global>();
    out[0] = global.a;
    out[1] = uint(global.view);
    out[2] = global.b;
    out[3] = global.c;
  });
  program.create("rg");
  program.dispatch.Width = program.dispatch.Height = program.dispatch.Depth = 1;
  CommandList list;
  list.SetComputeRootSignature(RootSignature().Constants(1).ShaderResourceView().Constants(2));
  const uint values[] = {7, 8, 9};
  list.SetComputeRoot32BitConstants(0, std::span(values).first(1));
  list.SetComputeRootShaderResourceView(1, 55);
  list.SetComputeRoot32BitConstants(2, std::span(values).subspan(1, 1));
  list.SetComputeRoot32BitConstants(2, std::span(values).subspan(2, 1), 1);
  CHECK_THROWS_AS(list.SetComputeRoot32BitConstants(2, values), InputError);
  CHECK_THROWS_AS(list.SetComputeRootConstantBufferView(1, 0), InputError);
  CHECK_THROWS_AS(list.SetComputeRootShaderResourceView(3, 0), InputError);
  list.SetPipelineState1(program.pipeline);
  list.DispatchRays(program.dispatch);
  program.device.execute(list);
  CHECK(log.download<uint>(4) == std::vector<uint>{7, 55, 8, 9});
}

TEST_CASE("ST-04: a local root struct that does not fit its record reads as zeros") {
  CopyProgram program;
  program.dispatch.RayGenerationShaderRecord.SizeInBytes = 40;
  program.run();
  CHECK(program.log.as<uint>()[1] == 0);
  CHECK(program.reported("ST-04"));
}

TEST_CASE("builds refuse memory that is not there, wrong alignments and mixed geometry, by name") {
  Program program;
  const Buffer vertices = program.device.create_buffer(36);  // one page is committed
  const Buffer result = program.device.create_buffer(1 << 20);
  const auto build = [&](std::vector<RAYTRACING_GEOMETRY_DESC> geometries, uint64_t destination) {
    BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
    inputs.Type = RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL;
    inputs.NumDescs = uint(geometries.size());
    inputs.pGeometryDescs = geometries.data();
    CommandList list;
    list.BuildRaytracingAccelerationStructure({destination, inputs});
    program.device.execute(list);
  };
  const RAYTRACING_GEOMETRY_DESC good = triangle_geometry(vertices, 3);
  CHECK_NOTHROW(build({good}, result.address()));
  CHECK_THROWS_WITH(build({good}, result.address() + 128), Contains("BI-22"));
  CHECK_THROWS_WITH(build({good}, result.address() + result.bytes()), Contains("DestAccelerationStructureData"));
  RAYTRACING_GEOMETRY_DESC bad = good;
  bad.Triangles.VertexCount = 30000;
  CHECK_THROWS_WITH(build({good, bad}, result.address()), Contains("geometries[1].Triangles.VertexBuffer"));
  (bad = good).Triangles.VertexBuffer.StartAddress += 2;
  CHECK_THROWS_WITH(build({bad}, result.address()), Contains("BI-12"));
  (bad = good).Triangles.Transform3x4 = 8;
  CHECK_THROWS_WITH(build({bad}, result.address()), Contains("BI-16"));
  (bad = good).Triangles.VertexFormat = VERTEX_FORMAT(16);
  CHECK_THROWS_WITH(build({bad}, result.address()), Contains("BI-06"));
  CHECK_THROWS_WITH(build({good, aabb_geometry(vertices, 1)}, result.address()), Contains("BI-03"));
  CHECK_THROWS_WITH(build({aabb_geometry(vertices, 1, 20)}, result.address()), Contains("BI-20"));
  CHECK_THROWS_WITH(build({aabb_geometry(vertices, ~uint64_t{0})}, result.address()), Contains("CAP-09"));
  CHECK_THROWS_WITH(build({aabb_geometry(vertices, 3000)}, result.address()), Contains("geometries[0]"));
  RAYTRACING_INSTANCE_DESC lost = instance(AccelerationStructure());
  lost.AccelerationStructure = 0x10000;
  CHECK_THROWS_WITH(program.scene({lost}), Contains("InstanceDescs[0]"));
  lost.AccelerationStructure = vertices.address();
  CHECK_THROWS_AS(program.scene({lost}), InputError);
}

TEST_CASE("PB-02, BI-02, TL-02: prebuild looks at no address; arrays of pointers give the same scene") {
  Program program;
  RAYTRACING_GEOMETRY_DESC bogus;
  bogus.Triangles = {16, FORMAT_R32_UINT, FORMAT_R32G32B32_FLOAT, 300, 100, 0x1000, {0x2000, 12}};
  const RAYTRACING_GEOMETRY_DESC* pointers[] = {&bogus, &bogus};
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
  inputs.Type = RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL;
  inputs.NumDescs = 2;
  inputs.DescsLayout = ELEMENTS_LAYOUT_ARRAY_OF_POINTERS;
  inputs.ppGeometryDescs = pointers;
  const auto two = program.device.GetRaytracingAccelerationStructurePrebuildInfo(inputs);
  inputs.NumDescs = 1;
  const auto one = program.device.GetRaytracingAccelerationStructurePrebuildInfo(inputs);
  CHECK(one.ResultDataMaxSizeInBytes > 0);
  CHECK(two.ResultDataMaxSizeInBytes >= one.ResultDataMaxSizeInBytes);

  const std::vector<RAYTRACING_INSTANCE_DESC> instances(2, instance(program.layers({1})));
  const Buffer descs = program.device.upload(instances);
  const Buffer addresses = program.device.upload(std::vector<uint64_t>{descs.address() + 64, descs.address()});
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS top;
  top.NumDescs = 2;
  top.DescsLayout = ELEMENTS_LAYOUT_ARRAY_OF_POINTERS;
  top.InstanceDescs = addresses.address();
  const auto size = program.device.GetRaytracingAccelerationStructurePrebuildInfo(top).ResultDataMaxSizeInBytes;
  const Buffer a = program.device.create_buffer(size), b = program.device.create_buffer(size);
  CommandList list;
  list.BuildRaytracingAccelerationStructure({a.address(), top});
  top.DescsLayout = ELEMENTS_LAYOUT_ARRAY;
  top.InstanceDescs = descs.address();
  list.BuildRaytracingAccelerationStructure({b.address(), top});
  program.device.execute(list);
  CHECK(std::equal(a.host().begin(), a.host().end(), b.host().begin()));
}
