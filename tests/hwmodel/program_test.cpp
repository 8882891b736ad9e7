// A whole DXR program, with every kind of shader, run natively, captured, and replayed.

#include <rayloom/base/parallel.h>
#include <rayloom/hwmodel/parameters.h>
#include <rayloom/hwmodel/recording_tracer.h>
#include <rayloom/hwmodel/replay.h>
#include <rayloom/runtime/rayloom.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <numeric>

using namespace rayloom;
using namespace rayloom::hwmodel;

namespace {

struct Payload {
  float3 color;
  uint depth;
};
struct SphereAttributes {
  float3 normal;
};

constexpr uint width = 37, height = 29;  // odd sizes: cut tiles, a last warp that is not full

struct RayGen {
  RaytracingAccelerationStructure scene;
  RWTexture2D<float4> output;
  void operator()(RayGenContext& ctx) const {
    const uint3 index = ctx.DispatchRaysIndex();
    Payload payload{float3(0), 0};
    const float3 direction(float(index.x) / width - 0.5f, float(index.y) / height - 0.5f, 1);
    ctx.TraceRay(scene, 0, 0xFF, 0, 1, 0, {float3(0, 0, -4), 0, direction, 100}, payload);
    ctx.CallShader(0, payload);
    output[uint2(index)] = float4(payload.color, 1);
  }
};

template <class Context>
void bounce(Context& ctx, RaytracingAccelerationStructure scene, Payload& payload, const float3& normal) {
  const float3 point = ctx.WorldRayOrigin() + ctx.RayTCurrent() * ctx.WorldRayDirection();
  Payload next{float3(0), payload.depth + 1};
  if (payload.depth < 2)
    ctx.TraceRay(scene, 0, 0xFF, 0, 1, 0, {point, 0.01f, ctx.WorldRayDirection() - 2.2f * normal, 100}, next);
  payload.color = 0.25f * normal + 0.5f * next.color;
}

/// Everything a test needs, built once a case.
struct Program {
  Device device;
  Buffer picture, vertices, holed_vertices, boxes;
  AccelerationStructure mesh, spheres, scene;
  std::shared_ptr<const StateObject> pipeline;
  ShaderTable ray_generation, miss, hit_groups, callables;
  CommandList list;

  explicit Program(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_NONE);
  std::vector<std::byte> run(Tracer* tracer = nullptr) {
    picture.upload(std::span<const std::byte>(std::vector<std::byte>(picture.bytes())));
    device.execute(list, {.tracer = tracer});
    return picture.download<std::byte>(picture.bytes());
  }

 private:
  void build_scene(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags);
  ShaderLibrary shaders() const;
};

void Program::build_scene(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags) {
  std::vector<float3> corners;
  for (int i = 0; i < 200; ++i)
    for (int corner = 0; corner < 3; ++corner)
      corners.push_back(float3(float((i * 37 + corner * 23) % 50) / 10 - 2.5f,
                               float((i * 13 + corner * 31) % 40) / 10 - 2, float((i * 7 + corner * 3) % 30) / 10));
  vertices = device.upload(std::span<const float3>(corners).first(300));
  holed_vertices = device.upload(std::span<const float3>(corners).last(300));
  std::vector<RAYTRACING_AABB> spheres_boxes;
  for (int i = 0; i < 30; ++i) {
    const float3 c(float(i * 7 % 11) / 3 - 2, float(i * 5 % 9) / 3 - 1.5f, float(i * 3 % 13) / 3);
    spheres_boxes.push_back({c.x - 0.3f, c.y - 0.3f, c.z - 0.3f, c.x + 0.3f, c.y + 0.3f, c.z + 0.3f});
  }
  boxes = device.upload(spheres_boxes);
  const RAYTRACING_GEOMETRY_DESC geometries[] = {
      triangle_geometry(vertices, 300), triangle_geometry(holed_vertices, 300, 12, RAYTRACING_GEOMETRY_FLAG_NONE)};
  mesh = build_bottom_level(device, geometries, flags);
  spheres = build_bottom_level(device, {aabb_geometry(boxes, 30)});
  RAYTRACING_INSTANCE_DESC second = instance(spheres);
  second.InstanceContributionToHitGroupIndex = 2;
  scene = build_top_level(device, {instance(mesh), second});
}

ShaderLibrary Program::shaders() const {
  ShaderLibrary library;
  const RaytracingAccelerationStructure view = scene.view();
  const StructuredBuffer<RAYTRACING_AABB> all_boxes = boxes.structured<RAYTRACING_AABB>();
  library.RayGeneration("RayGen", RayGen{view, picture.rw_texture<float4>(width, height)}, {.cost = {50, 4}});
  library.ClosestHit(
      "Shade", [=](ClosestHitContext& ctx, Payload& payload, const BuiltInTriangleIntersectionAttributes& attributes) {
        ctx.Branch(ctx.PrimitiveIndex() % 2);
        bounce(ctx, view, payload, float3(attributes.barycentrics, 0.3f));
      });
  library.ClosestHit("ShadeSphere", [=](ClosestHitContext& ctx, Payload& payload, const SphereAttributes& attributes) {
    bounce(ctx, view, payload, attributes.normal);
  });
  library.AnyHit("Holes", [](AnyHitContext& ctx, Payload&, const BuiltInTriangleIntersectionAttributes& attributes) {
    return attributes.barycentrics.x < 0.3f ? ctx.IgnoreHit() : ctx.AcceptHit();
  });
  library.Intersection("Sphere", [=](IntersectionContext& ctx) -> IntersectionVerdict {
    const RAYTRACING_AABB box = all_boxes[ctx.PrimitiveIndex()];
    const float3 center(box.MinX + 0.3f, box.MinY + 0.3f, box.MinZ + 0.3f);
    const float3 o = ctx.WorldRayOrigin() - center, d = ctx.WorldRayDirection();
    const float a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 0.09f;
    if (b * b < a * c) return ctx.EndIntersection();
    const float t = (-b - std::sqrt(b * b - a * c)) / a;
    return ctx.ReportHit(t, 0, SphereAttributes{(o + t * d) / 0.3f});
  });
  library.Miss("Sky", [](MissContext& ctx, Payload& payload) { payload.color = 0.2f * ctx.WorldRayDirection(); });
  library.Callable("Tone", [](CallableContext&, Payload& payload) { payload.color *= 0.9f; });
  return library;
}

Program::Program(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags) {
  picture = device.create_buffer(width * height * sizeof(float4));
  build_scene(flags);
  STATE_OBJECT_DESC desc;
  desc.add(DXIL_LIBRARY_DESC{shaders()});
  desc.add(HIT_GROUP_DESC{.HitGroupExport = "Solid", .ClosestHitShaderImport = "Shade"});
  desc.add(HIT_GROUP_DESC{.HitGroupExport = "Holed", .AnyHitShaderImport = "Holes", .ClosestHitShaderImport = "Shade"});
  desc.add(HIT_GROUP_DESC{.HitGroupExport = "Spheres",
                          .Type = HIT_GROUP_TYPE_PROCEDURAL_PRIMITIVE,
                          .ClosestHitShaderImport = "ShadeSphere",
                          .IntersectionShaderImport = "Sphere"});
  desc.add(RAYTRACING_SHADER_CONFIG{.MaxPayloadSizeInBytes = sizeof(Payload), .MaxAttributeSizeInBytes = 12});
  desc.add(RAYTRACING_PIPELINE_CONFIG{.MaxTraceRecursionDepth = 4});
  pipeline = device.CreateStateObject(desc);
  ray_generation = ShaderTableBuilder(*pipeline).add("RayGen").build(device);
  miss = ShaderTableBuilder(*pipeline).add("Sky").build(device);
  hit_groups = ShaderTableBuilder(*pipeline).add("Solid").add("Holed").add("Spheres").build(device);
  callables = ShaderTableBuilder(*pipeline).add("Tone").build(device);
  list.SetPipelineState1(pipeline);
  list.DispatchRays({ray_generation, miss, hit_groups, callables, width, height, 1});
}

GpuConfig two_sms() {
  GpuPreset preset = make_preset("turing");
  set_parameter(preset, "sm.count=2");
  return preset.config;
}

bool same_warp(const WarpCapture& a, const WarpCapture& b) {
  const auto same_segment = [](const Segment& x, const Segment& y) {
    return x.signature == y.signature && x.record == y.record && x.shader == y.shader && x.alu == y.alu &&
           x.special == y.special && x.access_begin == y.access_begin && x.access_count == y.access_count &&
           x.ray == y.ray && x.depth == y.depth && x.end == y.end && x.begins == y.begins;
  };
  const auto same_access = [](const MemoryAccess& x, const MemoryAccess& y) {
    return x.address == y.address && x.bytes == y.bytes && x.kind == y.kind && x.store_data == y.store_data;
  };
  return a.events == b.events && a.store_data == b.store_data && a.rays.size() == b.rays.size() &&
         a.candidates.size() == b.candidates.size() &&
         std::equal(a.segments.begin(), a.segments.end(), b.segments.begin(), b.segments.end(), same_segment) &&
         std::equal(a.accesses.begin(), a.accesses.end(), b.accesses.begin(), b.accesses.end(), same_access);
}

}  // namespace

TEST_CASE("the simulated GPU computes the native picture") {
  Program program;
  const std::vector<std::byte> native = program.run();
  RecordingTracer tracer;
  CHECK(program.run(&tracer) == native);
  REQUIRE(tracer.captures().size() == 1);
  const CaptureCounts counts = count(tracer.captures()[0]);
  CHECK(counts.rays > width * height);
  CHECK(counts.candidates > 0);
  CHECK(counts.procedural_leaves > 0);

  const ReplayResult result = replay(tracer.captures(), two_sms());
  std::vector<std::byte> simulated(native.size());
  CHECK(result.memory.bytes_stored(program.picture.address(), native.size()) == native.size());
  result.memory.read(program.picture.address(), simulated);
  CHECK(simulated == native);
  std::vector<std::string> ran;
  for (const NamedShaderStats& shader : result.stats.shaders) ran.push_back(shader.name);
  CHECK_THAT(ran, Catch::UnorderedEquals(
                      std::vector<std::string>{"Tone", "Holes", "RayGen", "Shade", "ShadeSphere", "Sky", "Sphere"}));
  CHECK(result.stats.rays_by_depth.size() == 3);
  const auto& pixels = result.pixel_cycles.at(0);
  CHECK(pixels.size() == width * height);
  CHECK(std::accumulate(pixels.begin(), pixels.end(), uint64_t{0}) == result.stats.sm.lane_busy_cycles);
  CHECK(std::count(pixels.begin(), pixels.end(), 0) == 0);
}

TEST_CASE("captures and replays are the same for any number of host threads") {
  Program program;
  std::vector<Capture> captures;
  for (const unsigned threads : {1u, 4u}) {
    const ThreadLimit limit(threads);
    RecordingTracer tracer;
    program.run(&tracer);
    captures.push_back(std::move(tracer.take().front()));
  }
  REQUIRE(captures[0].warps.size() == captures[1].warps.size());
  for (size_t i = 0; i < captures[0].warps.size(); ++i) CHECK(same_warp(captures[0].warps[i], captures[1].warps[i]));
  CHECK(captures[0].header.structures.size() == 3);
  CHECK(captures[1].header.structures.size() == 3);
  const ReplayResult a = replay({&captures[0], 1}, two_sms()), b = replay({&captures[1], 1}, two_sms());
  CHECK(a.stats.cycles == b.stats.cycles);
  CHECK(a.stats.rt.slots == b.stats.rt.slots);
  CHECK(a.pixel_cycles == b.pixel_cycles);
}

TEST_CASE("a lazy scene gives the same picture, and is complete when it is captured") {
  const std::vector<std::byte> expected = Program().run();
  const auto info = [](const Program& program) {
    return accel::structure_info(program.device.memory().host(program.mesh.address()));
  };
  std::vector<Capture> captures;
  for (const bool traced_before : {false, true}) {
    Program program(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_LAZY);
    CHECK(info(program).built_parts == 0);
    if (traced_before) {
      CHECK(program.run() == expected);
      CHECK(info(program).built_parts > 0);
    }
    CHECK(info(program).lazy);
    RecordingTracer tracer;
    CHECK(program.run(&tracer) == expected);
    CHECK(!info(program).lazy);
    captures.push_back(std::move(tracer.take().front()));
    std::vector<std::byte> simulated(expected.size());
    replay({&captures.back(), 1}, two_sms()).memory.read(program.picture.address(), simulated);
    CHECK(simulated == expected);
    CHECK(program.run() == expected);
  }
  REQUIRE(captures[0].warps.size() == captures[1].warps.size());
  for (size_t i = 0; i < captures[0].warps.size(); ++i) CHECK(same_warp(captures[0].warps[i], captures[1].warps[i]));
}

TEST_CASE("warps of other sizes, and lanes one after another, come to the same picture") {
  Program program;
  const std::vector<std::byte> native = program.run();
  const uint32_t warp_size = GENERATE(1u, 8u, 64u);
  const ExecutionMode mode = GENERATE(ExecutionMode::warp, ExecutionMode::direct);
  RecordingTracer tracer;
  program.device.execute(program.list, {.mode = mode, .warp_size = warp_size, .tracer = &tracer});
  std::vector<std::byte> simulated(native.size());
  replay(tracer.captures(), two_sms()).memory.read(program.picture.address(), simulated);
  CHECK(simulated == native);
}
