// Rows DET, DR-13, ERR-09, ERR-10: the same results for any thread count, warp size, mode and tracer; exceptions.

#include "program.h"
#include "reference_tracer.h"

#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>
#include <rayloom/runtime/grid_order.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <set>
#include <stdexcept>

using namespace rayloom;
using namespace rayloom::test;

namespace {

constexpr uint width = 61, height = 23;

struct Path {
  uint hash;
  uint depth;
};

uint mixed(uint a, uint b) { return static_cast<uint>(hash64(a, b)); }

/// Every stage, nested and divergent; each lane writes a hash of all its shader calls in order.
class Everything : public Program {
 public:
  Everything() : Program(4) {
    picture = device.create_buffer(width * height * sizeof(uint));
    std::vector<RAYTRACING_INSTANCE_DESC> instances;
    const AccelerationStructure& slabs = layers({1, 1.5f, 3, 6}, {RAYTRACING_GEOMETRY_FLAG_NONE});
    const AccelerationStructure& spheres = boxes({2, 4}, RAYTRACING_GEOMETRY_FLAG_NONE);
    for (uint i = 0; i < 12; ++i) {
      const float x = float(i % 4) * 0.5f - 0.75f, y = float(i / 4) * 0.6f - 0.6f;
      instances.push_back(instance(i % 2 ? spheres : slabs, {float4(0.06f, 0, 0, x), float4(0, 0.06f, 0, y),
                                                             float4(0, 0, 1, float(i) * 0.25f)}));
      instances.back().InstanceContributionToHitGroupIndex = i % 2;
    }
    const auto scene_view = scene(instances);
    const auto out = picture.rw_texture<uint>(width, height);
    shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
      const uint3 at = ctx.DispatchRaysIndex();
      Path path{mixed(at.x, at.y), 0};
      const RayDesc ray{float3(float(at.x) / width * 2 - 1, float(at.y) / height * 2 - 1, -1), 0, float3(0, 0, 1), 100};
      for (uint i = 0; i <= at.x % 3; ++i) ctx.TraceRay(scene_view, 0, 0xFF, 0, 0, 0, ray, path);
      out[at] = path.hash;
    });
    shaders.ClosestHit("ch", [=](ClosestHitContext& ctx, Path& path, const Barycentrics& attributes) {
      path.hash = mixed(path.hash, std::bit_cast<uint>(attributes.barycentrics.x));
      bounce(ctx, scene_view, path);
    });
    shaders.ClosestHit("sphere_ch", [=](ClosestHitContext& ctx, Path& path, const Value& attributes) {
      path.hash = mixed(path.hash, attributes.value);
      bounce(ctx, scene_view, path);
    });
    shaders.AnyHit("ah", [](AnyHitContext& ctx, Path& path, const Barycentrics&) {
      path.hash = mixed(path.hash, ctx.InstanceIndex() * 8 + ctx.GeometryIndex());
      return path.hash % 4 == 0 ? ctx.IgnoreHit() : ctx.AcceptHit();
    });
    shaders.Intersection("is", [](IntersectionContext& ctx) -> IntersectionVerdict {
      const float3 o = ctx.ObjectRayOrigin();
      const float z = ctx.GeometryIndex() ? 4.0f : 2.0f;
      if (o.x * o.x + o.y * o.y > 0.8f) return ctx.EndIntersection();
      return ctx.ReportHit((z - o.z) / ctx.ObjectRayDirection().z, 1, Value{ctx.InstanceIndex()});
    });
    shaders.Miss("ms", [](MissContext& ctx, Path& path) { ctx.CallShader(path.hash % 2, path); });
    shaders.Callable("ca", [](CallableContext&, Path& path) { path.hash = mixed(path.hash, 77); });
    shaders.Callable("cb", [](CallableContext&, Path& path) { path.hash = mixed(path.hash, 99); });
    hit_group("slab", "ch", "ah").hit_group("sphere", "sphere_ch", "", "is");
    create("rg", {"ms"}, {"slab", "sphere"}, {"ca", "cb"});
  }

  static void bounce(ClosestHitContext& ctx, RaytracingAccelerationStructure scene_view, Path& path) {
    if (++path.depth > 3) return;
    RayDesc ray{ctx.WorldRayOrigin(), ctx.RayTCurrent(), ctx.WorldRayDirection(), 100};
    if (path.hash % 2) ray.Direction = -ray.Direction;
    ctx.TraceRay(scene_view, 0, 0xFF, 0, 0, 0, ray, path);
  }

  std::pair<std::vector<uint>, DispatchStatistics> render(const DispatchOptions& options = {}) {
    picture.upload(std::span<const uint>(std::vector<uint>(width * height)));
    const DispatchReport report = run(width, height, 1, options);
    if (options.mode != ExecutionMode::automatic) CHECK(report.mode == options.mode);
    CHECK(report.warp_size == options.warp_size);
    return {picture.download<uint>(width * height), report.statistics};
  }

  Buffer picture;
};

}  // namespace

TEST_CASE("images, logs and statistics are equal over threads, warp sizes and modes") {
  Everything program;
  const auto expected = program.render();
  CHECK(expected.second.hits > width * height / 10);
  CHECK(expected.second.any_hit > 0);
  CHECK(expected.second.intersection > 0);
  CHECK(expected.second.callable > 0);
  CHECK(expected.second.rays > 2 * width * height);
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    CHECK(program.render() == expected);
  }
  for (const uint32_t warp_size : {1u, 5u, 16u, 32u, 64u})
    for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
      CAPTURE(warp_size, int(mode));
      DispatchOptions options;
      options.mode = mode;
      options.warp_size = warp_size;
      CHECK(program.render(options) == expected);
    }
  CHECK(program.messages.empty());
}

TEST_CASE("every instruction set gives the same picture") {
  Everything program;
  const accel::Isa before = accel::current_isa();
  const auto expected = program.render();
  for (const accel::Isa isa : {accel::Isa::scalar, accel::Isa::avx2, accel::Isa::avx512}) {
    if (!accel::isa_supported(isa)) continue;
    accel::set_isa(isa);
    CHECK(accel::current_isa() == isa);
    CHECK(program.render() == expected);
  }
  accel::set_isa(before);
}

TEST_CASE("the validation layer changes nothing (ERR-09)") {
  Everything program;
  const auto expected = program.render();
  program.device.set_validation_callback({});
  CHECK(program.render() == expected);
}

TEST_CASE("the automatic mode: warps, unless nothing can be gathered") {
  Everything program;
  CHECK(program.run(8).mode == ExecutionMode::warp);
  DispatchOptions options;
  options.warp_size = 1;
  CHECK(program.run(8, 1, 1, options).mode == ExecutionMode::direct);
  ReferenceTracer reference;
  options.tracer = &reference;
  CHECK(program.run(8, 1, 1, options).mode == ExecutionMode::warp);
  options.warp_size = 65;
  CHECK_THROWS(program.run(8, 1, 1, options));
  options.warp_size = 0;
  CHECK_THROWS(program.run(8, 1, 1, options));
}

TEST_CASE("grid_index visits every thread once, in tiles") {
  for (const auto& [w, h, d] : {std::tuple(1u, 1u, 1u), std::tuple(8u, 4u, 1u), std::tuple(13u, 7u, 2u),
                                std::tuple(100u, 1u, 1u), std::tuple(1u, 100u, 1u), std::tuple(9u, 5u, 3u)}) {
    std::set<std::tuple<uint32_t, uint32_t, uint32_t>> seen;
    for (uint64_t i = 0; i < uint64_t{w} * h * d; ++i) {
      const GridIndex at = grid_index(w, h, i);
      CHECK((at.x < w && at.y < h && at.z < d));
      seen.emplace(at.z, at.y, at.x);
    }
    CHECK(seen.size() == uint64_t{w} * h * d);
  }
  const GridIndex second_tile = grid_index(64, 64, 32);
  CHECK((second_tile.x == 8 && second_tile.y == 0));
  const GridIndex last_of_first = grid_index(64, 64, 31);
  CHECK((last_of_first.x == 7 && last_of_first.y == 3));
}

TEST_CASE("GridWalk goes where grid_index says, from any start") {
  for (const auto& [w, h, d] : {std::tuple(1u, 1u, 1u), std::tuple(8u, 4u, 1u), std::tuple(13u, 7u, 2u),
                                std::tuple(100u, 1u, 1u), std::tuple(1u, 100u, 2u), std::tuple(9u, 5u, 3u)})
    for (uint64_t start = 0; start < uint64_t{w} * h * d; start += 7) {
      GridWalk walk(w, h, start);
      bool same = true;
      for (uint64_t i = start; i < uint64_t{w} * h * d; ++i, ++walk) {
        const GridIndex at = grid_index(w, h, i);
        same = same && at.x == (*walk).x && at.y == (*walk).y && at.z == (*walk).z;
      }
      CHECK(same);
    }
}

namespace {

struct Counted {
  explicit Counted(std::atomic<int>& counter) : alive(counter) { ++alive; }
  ~Counted() { --alive; }
  std::atomic<int>& alive;
};

/// Throws from a given stage in threads 17 and above; every shader holds an object that must be destroyed.
void make_throwing(Program& program, std::atomic<int>& alive, ShaderStage where) {
  const auto check = [where](ShaderStage stage, uint3 at) {
    if (stage == where && at.x >= 17) throw std::runtime_error("thread " + std::to_string(at.x));
  };
  RAYTRACING_INSTANCE_DESC triangle = instance(program.layers({1}, {RAYTRACING_GEOMETRY_FLAG_NONE}));
  RAYTRACING_INSTANCE_DESC box = instance(program.boxes({-0.5f}));
  box.InstanceContributionToHitGroupIndex = 1;
  const auto scene = program.scene({triangle, box});
  program.shaders.RayGeneration("rg", [=, &alive](RayGenContext& ctx) {
    const Counted counted(alive);
    Value payload{0};
    ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    check(ShaderStage::ray_generation, ctx.DispatchRaysIndex());
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
  });
  program.shaders.ClosestHit("ch", [=, &alive](ClosestHitContext& ctx, Value& payload, const Barycentrics&) {
    const Counted counted(alive);
    ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    check(ShaderStage::closest_hit, ctx.DispatchRaysIndex());
  });
  program.shaders.AnyHit("ah", [=, &alive](AnyHitContext& ctx, Value&, const Barycentrics&) {
    const Counted counted(alive);
    check(ShaderStage::any_hit, ctx.DispatchRaysIndex());
    return ctx.AcceptHit();
  });
  program.shaders.Intersection("is", [=, &alive](IntersectionContext& ctx) {
    const Counted counted(alive);
    check(ShaderStage::intersection, ctx.DispatchRaysIndex());
    return ctx.EndIntersection();
  });
  program.shaders.Miss("ms", [=, &alive](MissContext& ctx, Value& payload) {
    const Counted counted(alive);
    check(ShaderStage::miss, ctx.DispatchRaysIndex());
    ctx.CallShader(0, payload);
  });
  program.shaders.Callable("ca", [=, &alive](CallableContext& ctx, Value&) {
    const Counted counted(alive);
    check(ShaderStage::callable, ctx.DispatchRaysIndex());
  });
  program.hit_group("hg", "ch", "ah").hit_group("box", "", "", "is");
  program.create("rg", {"ms"}, {"hg", "box"}, {"ca"});
}

}  // namespace

TEST_CASE("ERR-10: an exception of any stage unwinds every lane and leaves DispatchRays, the lowest lane's first") {
  for (const ShaderStage stage : {ShaderStage::ray_generation, ShaderStage::intersection, ShaderStage::any_hit,
                                  ShaderStage::closest_hit, ShaderStage::miss, ShaderStage::callable})
    for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
      CAPTURE(int(stage), int(mode));
      Program program(2);
      std::atomic<int> alive = 0;
      make_throwing(program, alive, stage);
      DispatchOptions options;
      options.mode = mode;
      CHECK_THROWS_WITH(program.run(300, 1, 1, options), "thread 17");
      CHECK(alive == 0);
      CHECK(program.device.GetDeviceRemovedReason().empty());
      CHECK_NOTHROW(program.run(17, 1, 1, options));
    }
}

TEST_CASE("a shader may trace inside a catch block") {
  Program program(1);
  const Buffer log = program.counters();
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    const uint x = ctx.DispatchRaysIndex().x;
    Value payload{0};
    try {
      throw x;
    } catch (const uint& caught) {
      for (uint i = 0; i < 1 + x % 3; ++i) ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
      try {
        throw;
      } catch (const uint& again) {
        out[x] = again == x && caught == x ? 1 + payload.value : 0;
      }
    }
  });
  program.shaders.Miss("ms", [](MissContext&, Value& payload) { ++payload.value; });
  program.create("rg", {"ms"});
  program.run(40);
  for (uint i = 0; i < 40; ++i) CHECK(log.as<uint>()[i] == 2 + i % 3);
}

namespace {
class FailingTracer final : public Tracer {
 public:
  bool observes_shaders() const override { return false; }
  std::unique_ptr<WarpTracer> begin_warp(uint64_t) override {
    struct Failing final : WarpTracer {
      void trace(std::span<TraceCall>) override { throw std::runtime_error("tracer"); }
    };
    return std::make_unique<Failing>();
  }
  void end_warp(uint64_t, std::unique_ptr<WarpTracer>) override {}
};
}  // namespace

TEST_CASE("a tracer that throws unwinds the lanes too") {
  for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
    Program program(2);
    std::atomic<int> alive = 0;
    make_throwing(program, alive, ShaderStage::miss);
    FailingTracer tracer;
    DispatchOptions options;
    options.mode = mode;
    options.tracer = &tracer;
    CHECK_THROWS_WITH(program.run(100, 1, 1, options), "tracer");
    CHECK(alive == 0);
  }
}
