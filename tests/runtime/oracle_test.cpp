// Random programs under the native tracer and under the oracle that has no tree.

#include "program.h"
#include "reference_tracer.h"

#include <rayloom/base/hash.h>

#include <catch2/catch.hpp>
#include <cmath>

using namespace rayloom;
using namespace rayloom::test;

namespace {

struct Result {
  uint kind;  // 0 untouched, 1 hit, 2 miss
  float t;
  uint instance, geometry, primitive, hit_kind;
  float2 weights;
};

class Random {
 public:
  explicit Random(uint64_t seed) : seed_(seed) {}
  float uniform(float low, float high) { return low + (high - low) * unit_float(hash64(seed_, ++count_)); }
  uint below(uint n) { return static_cast<uint>(hash64(seed_, ++count_) % n); }
  float3 point(float extent) { return {uniform(-extent, extent), uniform(-extent, extent), uniform(-extent, extent)}; }

 private:
  uint64_t seed_, count_ = 0;
};

/// Spheres of radius 1/2 in unit boxes, triangles in soups; instances under affine maps, some mirrored, with all flags.
RaytracingAccelerationStructure random_scene(Program& program, Random& random) {
  std::vector<const AccelerationStructure*> bottoms;
  for (int mesh = 0; mesh < 3; ++mesh) {
    std::vector<RAYTRACING_GEOMETRY_DESC> geometries;
    for (int g = 0; g < 2; ++g) {
      std::vector<float3> vertices;
      for (int i = 0; i < 40; ++i) {
        const float3 centre = random.point(2);
        for (int v = 0; v < 3; ++v) vertices.push_back(centre + random.point(1));
      }
      program.buffers.push_back(program.device.upload(vertices));
      const auto flags = g ? RAYTRACING_GEOMETRY_FLAG_OPAQUE : RAYTRACING_GEOMETRY_FLAG_NONE;
      geometries.push_back(triangle_geometry(program.buffers.back(), uint(vertices.size()), 12, flags));
    }
    program.structures.push_back(
        std::make_unique<AccelerationStructure>(build_bottom_level(program.device, geometries)));
    bottoms.push_back(program.structures.back().get());
  }
  std::vector<RAYTRACING_INSTANCE_DESC> instances;
  for (int i = 0; i < 12; ++i) {
    float3x4 transform;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) transform[row][column] = random.uniform(-0.4f, 0.4f) + (row == column);
      transform[row][3] = random.uniform(-6, 6);
    }
    if (random.below(3) == 0) transform[0] = -transform[0];
    RAYTRACING_INSTANCE_DESC desc = instance(*bottoms[random.below(3)], transform);
    desc.InstanceMask = (1 + random.below(255)) & 0xFFu;
    desc.Flags = (random.below(4) + random.below(3) * 4) & 0xFFu;
    instances.push_back(desc);
  }
  return program.scene(instances);
}

std::vector<Result> run_with(Program& program, Tracer* tracer, const Buffer& results, uint count) {
  results.upload(std::span<const Result>(std::vector<Result>(count)));
  DispatchOptions options;
  options.tracer = tracer;
  program.run(count, 1, 1, options);
  return results.download<Result>(count);
}

}  // namespace

TEST_CASE("random scenes, rays and flags: the native tracer finds what the oracle finds") {
  constexpr uint count = 500;
  constexpr uint flag_sets[] = {0, 0x1, 0x2, 0x10, 0x20, 0x40, 0x80, 0x22};
  uint hits = 0;
  for (uint seed = 0; seed < 16; ++seed) {
    Random random(seed);
    Program program;
    const auto scene = random_scene(program, random);
    const uint flags = flag_sets[seed % 8];
    std::vector<RayDesc> rays;
    for (uint i = 0; i < count; ++i) {
      const float3 origin = random.point(10);
      rays.push_back({origin, random.uniform(0, 2), random.point(4) - origin, random.uniform(2, 6)});
    }
    const Buffer ray_buffer = program.device.upload(rays);
    const Buffer results = program.device.create_buffer(count * sizeof(Result));
    program.shaders.RayGeneration("rg", [=, rays_view = ray_buffer.structured<RayDesc>(),
                                         out = results.rw_structured<Result>()](RayGenContext& ctx) {
      const uint i = ctx.DispatchRaysIndex().x;
      Result result{};
      ctx.TraceRay(scene, flags, 0x55, 0, 0, 0, rays_view[i], result);
      out[i] = result;
    });
    program.shaders.AnyHit("ah", [](AnyHitContext& ctx, Result&, const Barycentrics&) {
      return ctx.PrimitiveIndex() % 3 == 0 ? ctx.IgnoreHit() : ctx.AcceptHit();
    });
    program.shaders.ClosestHit("ch", [](ClosestHitContext& ctx, Result& result, const Barycentrics& attributes) {
      result = {1,
                ctx.RayTCurrent(),
                ctx.InstanceIndex(),
                ctx.GeometryIndex(),
                ctx.PrimitiveIndex(),
                ctx.HitKind(),
                attributes.barycentrics};
    });
    program.shaders.Miss("ms", [](MissContext&, Result& result) { result.kind = 2; });
    program.hit_group("hg", "ch", "ah");
    program.create("rg", {"ms"}, {"hg"});
    ReferenceTracer oracle;
    const auto native = run_with(program, nullptr, results, count),
               expected = run_with(program, &oracle, results, count);
    for (uint i = 0; i < count; ++i) {
      CAPTURE(seed, i);
      const Result &a = native[i], &b = expected[i];
      CHECK(a.kind == b.kind);
      if (a.kind != 1 || b.kind != 1) continue;
      ++hits;
      CHECK(a.t == Approx(b.t).epsilon(1e-5));
      CHECK(std::tie(a.instance, a.geometry, a.primitive, a.hit_kind) ==
            std::tie(b.instance, b.geometry, b.primitive, b.hit_kind));
      CHECK(glm::length(a.weights - b.weights) < 1e-3f);
    }
  }
  CHECK(hits > 1000);
}
