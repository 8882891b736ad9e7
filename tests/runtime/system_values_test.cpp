// Rows SV: what each stage sees.

#include "program.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;

namespace {

struct Values {
  float3 world_origin, world_direction, object_origin, object_direction;
  float t_min, t_current;
  uint flags, instance_index, instance_id, geometry_index, primitive_index, hit_kind;
  float3x4 object_to_world, world_to_object;
  float4x3 object_to_world_4x3, world_to_object_4x3;
};

template <ShaderStage S>
Values values_of(const StageContext<S>& ctx) {
  Values v{};
  v.world_origin = ctx.WorldRayOrigin();
  v.world_direction = ctx.WorldRayDirection();
  v.t_min = ctx.RayTMin();
  v.t_current = ctx.RayTCurrent();
  v.flags = ctx.RayFlags();
  if constexpr (HasPrimitive<S>) {
    v.object_origin = ctx.ObjectRayOrigin();
    v.object_direction = ctx.ObjectRayDirection();
    v.instance_index = ctx.InstanceIndex();
    v.instance_id = ctx.InstanceID();
    v.geometry_index = ctx.GeometryIndex();
    v.primitive_index = ctx.PrimitiveIndex();
    v.object_to_world = ctx.ObjectToWorld3x4();
    v.world_to_object = ctx.WorldToObject3x4();
    v.object_to_world_4x3 = ctx.ObjectToWorld4x3();
    v.world_to_object_4x3 = ctx.WorldToObject4x3();
  }
  if constexpr (HasHit<S>) v.hit_kind = ctx.HitKind();
  return v;
}

float3x4 transform() { return {float4(0, -2, 0, 5), float4(1, 0, 0, -3), float4(0, 0, 4, 8)}; }

}  // namespace

TEST_CASE("SV-22..SV-35: any-hit and closest-hit of a transformed triangle") {
  Program program;
  const Buffer log = program.device.create_buffer(3 * sizeof(Values));
  const auto out = log.rw_structured<Values>();
  std::vector<RAYTRACING_INSTANCE_DESC> instances(
      2, instance(program.layers({50, 1}, {RAYTRACING_GEOMETRY_FLAG_NONE}), transform()));
  instances[0].AccelerationStructure = 0;  // SV-27: inactive, but counts
  instances[1].InstanceID = 0xABCDEF;
  const auto scene = program.scene(instances);
  program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
    Value payload;
    ctx.TraceRay(scene, RAY_FLAG_CULL_BACK_FACING_TRIANGLES, 0xFF, 0, 0, 0,
                 {float3(5, -3, 2), 0.25f, float3(0, 0, 3), 1000.0f}, payload);
  });
  program.shaders.AnyHit("ah", [out](AnyHitContext& ctx, Value&, const Barycentrics&) {
    if (ctx.GeometryIndex() == 1) out[0] = values_of(ctx);
    return ctx.AcceptHit();
  });
  program.shaders.ClosestHit("ch",
                             [out](ClosestHitContext& ctx, Value&, const Barycentrics&) { out[1] = values_of(ctx); });
  program.hit_group("hg", "ch", "ah");
  program.create("rg", {""}, {"hg"});
  CHECK(program.run().statistics.closest_hit == 1);
  for (const Values& v : log.download<Values>(2)) {
    CHECK(v.world_origin == float3(5, -3, 2));
    CHECK(v.world_direction == float3(0, 0, 3));  // SV-22: not normalised
    CHECK(v.object_origin == float3(0, 0, -1.5f));
    CHECK(v.object_direction == float3(0, 0, 0.75f));
    CHECK(v.t_min == 0.25f);
    CHECK(v.t_current == 2.5f / 0.75f);
    CHECK(v.flags == RAY_FLAG_CULL_BACK_FACING_TRIANGLES);
    CHECK(v.instance_index == 1);
    CHECK(v.instance_id == 0xABCDEF);
    CHECK(v.geometry_index == 1);
    CHECK(v.primitive_index == 0);
    CHECK(v.hit_kind == HIT_KIND_TRIANGLE_FRONT_FACE);
    CHECK(v.object_to_world == transform());
    CHECK(v.object_to_world_4x3 == glm::transpose(v.object_to_world));
    CHECK(v.world_to_object_4x3 == glm::transpose(v.world_to_object));
    CHECK(mul(v.world_to_object, float4(mul(v.object_to_world, float4(1, 2, 3, 1)), 1)) == float3(1, 2, 3));
  }
}

TEST_CASE("SV-24, SV-25: RayTCurrent in every stage") {
  Program program;
  const Buffer log = program.device.create_buffer(64 * sizeof(float));
  const auto out = log.rw_structured<float>();
  const auto scene = program.scene(program.boxes({1}, RAYTRACING_GEOMETRY_FLAG_NONE));
  program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
    Value payload;
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.Intersection("is", [out](IntersectionContext& ctx) {
    out[0] = ctx.RayTCurrent();
    const bool far = bool(ctx.ReportHit(50.0f, 1, Value{}));
    out[1] = ctx.RayTCurrent();
    const bool ignored = bool(ctx.ReportHit(20.0f, 2, Value{}));
    out[2] = ctx.RayTCurrent();
    const ReportHitResult near = ctx.ReportHit(2.0f, 1, Value{});
    out[3] = ctx.RayTCurrent();
    out[4] = float(far) + 10 * float(ignored) + 100 * float(bool(near));
    return near;
  });
  program.shaders.AnyHit("ah", [out](AnyHitContext& ctx, Value&, const Value&) {
    out[5 + int(ctx.RayTCurrent())] = ctx.RayTCurrent();
    return ctx.HitKind() == 2 ? ctx.IgnoreHit() : ctx.AcceptHit();
  });
  program.shaders.ClosestHit("ch",
                             [out](ClosestHitContext& ctx, Value&, const Value&) { out[60] = ctx.RayTCurrent(); });
  program.shaders.Miss("ms", [out](MissContext& ctx, Value&) { out[61] = ctx.RayTCurrent(); });
  program.hit_group("hg", "ch", "ah", "is");
  program.create("rg", {"ms"}, {"hg"});
  const auto intersections = program.run().statistics.intersection;
  REQUIRE(intersections == 1);
  const auto v = log.as<float>();
  CHECK(v[0] == 100);
  CHECK(v[1] == 50);
  CHECK(v[2] == 50);
  CHECK(v[3] == 2);
  CHECK(v[4] == 101);
  CHECK((v[5 + 50] == 50 && v[5 + 20] == 20 && v[5 + 2] == 2));
  CHECK(v[60] == 2);
  CHECK(v[61] == 100);
}

TEST_CASE("SV-21: the outer ray's values are back after a nested trace") {
  Program program(2);
  const Buffer log = program.device.create_buffer(8 * sizeof(float3));
  const auto out = log.rw_structured<float3>();
  const auto scene = program.scene(program.layers({1}));
  program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
    Value payload;
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(0.5f), payload);
  });
  program.shaders.ClosestHit("ch", [out](ClosestHitContext& ctx, Value&, const Barycentrics&) {
    Value inner;
    ctx.TraceRay({}, RAY_FLAG_FORCE_OPAQUE, 0xFF, 0, 0, 0, {float3(9, 9, 9), 1, float3(1, 2, 3), 7}, inner);
    out[0] = ctx.WorldRayOrigin();
    out[1] = float3(ctx.RayTCurrent(), ctx.RayTMin(), float(ctx.RayFlags()));
  });
  program.shaders.Miss("ms", [out](MissContext& ctx, Value&) {
    out[2] = ctx.WorldRayOrigin();
    out[3] = float3(ctx.RayTCurrent(), ctx.RayTMin(), float(ctx.RayFlags()));
  });
  program.hit_group("hg", "ch");
  program.create("rg", {"ms"}, {"hg"});
  program.run();
  CHECK(log.download<float3>(4) ==
        std::vector<float3>{{0.5f, 0, -1}, {2, 0, 0}, {9, 9, 9}, {7, 1, RAY_FLAG_FORCE_OPAQUE}});
}

TEST_CASE("SV-20, DR-01: 3D index and dimensions in shaders of every depth") {
  Program program(3);
  const uint3 size(7, 5, 3);
  const Buffer log = program.device.create_buffer(7 * 5 * 3 * sizeof(uint4));
  const auto out = log.rw_structured<uint4>();
  const auto scene = program.scene(program.layers({1}));
  program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
    Value payload{0};
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.ClosestHit("ch", [scene](ClosestHitContext& ctx, Value& payload, const Barycentrics&) {
    Value inner{payload.value + 1};
    ctx.TraceRay(payload.value < 1 ? scene : RaytracingAccelerationStructure{}, 0, 0xFF, 0, 0, 0, straight_ray(),
                 inner);
  });
  program.shaders.Miss("ms", [](MissContext& ctx, Value& payload) { ctx.CallShader(0, payload); });
  program.shaders.Callable("ca", [out](CallableContext& ctx, Value& parameters) {
    const uint3 i = ctx.DispatchRaysIndex(), n = ctx.DispatchRaysDimensions();
    const uint linear = (i.z * n.y + i.y) * n.x + i.x;
    out[linear] = uint4(i, static_cast<uint4>(out[linear]).w + parameters.value);
  });
  program.hit_group("hg", "ch");
  program.create("rg", {"ms"}, {"hg"}, {"ca"});
  const DispatchStatistics statistics = program.run(size.x, size.y, size.z).statistics;
  CHECK(statistics.ray_generation == 105);
  CHECK(statistics.rays == 3 * 105);
  CHECK(statistics.callable == 105);
  const auto seen = log.as<uint4>();
  for (uint z = 0, linear = 0; z < size.z; ++z)
    for (uint y = 0; y < size.y; ++y)
      for (uint x = 0; x < size.x; ++x, ++linear) CHECK(seen[linear] == uint4(x, y, z, 2));
}

TEST_CASE("SV-26, RF-21, RF-23: pipeline flags skip a type and stay invisible") {
  Program program;
  program.config.Flags = RAYTRACING_PIPELINE_FLAG_SKIP_TRIANGLES;
  const Buffer log = program.counters();
  const auto out = log.rw_structured<uint>();
  const auto scene = program.scene({instance(program.layers({1})), instance(program.boxes({3}))});
  program.shaders.RayGeneration("rg", [scene](RayGenContext& ctx) {
    Value payload;
    ctx.TraceRay(scene, RAY_FLAG_FORCE_OPAQUE, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.Intersection("is", [out](IntersectionContext& ctx) {
    out[0] = ctx.RayFlags();
    return ctx.ReportHit(4.0f, 127, Value{5});
  });
  program.shaders.ClosestHit("ch", [out](ClosestHitContext& ctx, Value&, const Value& attributes) {
    out[1] = ctx.RayFlags();
    out[2] = ctx.HitKind();
    out[3] = attributes.value;
  });
  program.hit_group("hg", "ch", "", "is");
  program.create("rg", {""}, {"hg"});
  program.run();
  CHECK(log.download<uint>(4) == std::vector<uint>{RAY_FLAG_FORCE_OPAQUE, RAY_FLAG_FORCE_OPAQUE, 127, 5});
}
