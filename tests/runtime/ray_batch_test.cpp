// Rows TR-02, TR-11, DET: lanes that ask for different things at the same time, and different numbers of them.

#include "program.h"

#include <bit>
#include <catch2/catch.hpp>
#include <stdexcept>

using namespace rayloom;
using namespace rayloom::test;

namespace {

constexpr uint missed = 100;
constexpr uint occlusion = RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH | RAY_FLAG_SKIP_CLOSEST_HIT_SHADER;

/// Layer k is seen by masks with bit k; closest-hit adds its number plus 1.
RaytracingAccelerationStructure masked_layers(Program& program) {
  std::vector<RAYTRACING_INSTANCE_DESC> instances;
  for (uint k = 0; k < 8; ++k) {
    instances.push_back(instance(program.layers({1.0f + static_cast<float>(k)})));
    instances.back().InstanceMask = 1u << k;
  }
  program.shaders.ClosestHit("ch", [](ClosestHitContext& ctx, Value& payload, const Barycentrics&) {
    payload.value += ctx.InstanceIndex() + 1;
  });
  program.shaders.Miss("ms", [](MissContext&, Value& payload) { payload.value += missed; });
  program.hit_group("hg", "ch");
  return program.scene(instances);
}

DispatchOptions options_of(uint32_t warp_size, ExecutionMode mode = ExecutionMode::warp) {
  DispatchOptions options;
  options.warp_size = warp_size;
  options.mode = mode;
  return options;
}

uint mask_of(uint lane) { return lane * 37 & 0xFFu; }
uint flags_of(uint lane) { return lane % 3 == 0 ? occlusion : lane % 3 == 1 ? RAY_FLAG_NONE : RAY_FLAG_FORCE_OPAQUE; }

uint answer_for(uint lane) {
  const uint mask = mask_of(lane);
  if (lane % 5 == 0 || mask == 0) return missed;
  return lane % 3 == 0 ? 0 : static_cast<uint>(std::countr_zero(mask)) + 1;
}

}  // namespace

TEST_CASE("lanes that agree in nothing: structures, flags and masks by the dozen in one batch") {
  constexpr uint lanes = 700;
  Program program;
  const RaytracingAccelerationStructure scene = masked_layers(program);
  const Buffer log = program.counters(lanes);
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    const uint lane = ctx.DispatchRaysIndex().x;
    Value payload{0};
    ctx.TraceRay(lane % 5 == 0 ? RaytracingAccelerationStructure{} : scene, flags_of(lane), mask_of(lane), 0, 0, 0,
                 straight_ray(), payload);
    out[lane] = payload.value + 1;
  });
  program.create("rg", {"ms"}, {"hg"});
  for (const uint32_t warp_size : {1u, 5u, 32u, 64u})
    for (const ExecutionMode mode : {ExecutionMode::warp, ExecutionMode::direct}) {
      CAPTURE(warp_size, int(mode));
      log.upload(std::span<const uint>(std::vector<uint>(lanes)));
      program.run(lanes, 1, 1, options_of(warp_size, mode));
      const std::vector<uint> answers = log.download<uint>(lanes);
      uint wrong = 0;
      for (uint lane = 0; lane < lanes; ++lane) wrong += answers[lane] != answer_for(lane) + 1;
      CHECK(wrong == 0);
    }
}

TEST_CASE("each lane runs once, whatever number of rays it and its neighbours trace") {
  constexpr uint lanes = 3000;
  Program program;
  const RaytracingAccelerationStructure scene = masked_layers(program);
  const Buffer log = program.counters(lanes);
  const auto out = log.rw_structured<uint>();
  const auto rays_of = [](uint lane) { return lane / 500 % 2 ? lane % 500 * 7919 % 13 : lane % 500 / 100; };
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    const uint lane = ctx.DispatchRaysIndex().x;
    Value payload{0};
    for (uint i = 0; i < rays_of(lane); ++i) ctx.TraceRay(scene, 0, 0x80, 0, 0, 0, straight_ray(), payload);
    InterlockedAdd(out[lane], 1000 + payload.value);
  });
  program.create("rg", {"ms"}, {"hg"});
  uint rays = 0;
  for (uint lane = 0; lane < lanes; ++lane) rays += rays_of(lane);
  for (const uint32_t warp_size : {1u, 7u, 32u, 64u}) {
    CAPTURE(warp_size);
    log.upload(std::span<const uint>(std::vector<uint>(lanes)));
    const DispatchReport report = program.run(lanes, 1, 1, options_of(warp_size));
    CHECK(report.statistics.rays == rays);
    CHECK(report.statistics.ray_generation == lanes);
    const std::vector<uint> answers = log.download<uint>(lanes);
    uint wrong = 0;
    for (uint lane = 0; lane < lanes; ++lane) wrong += answers[lane] != 1000 + 8 * rays_of(lane);
    CHECK(wrong == 0);
  }
}

namespace {
/// Fails the first batch of each warp; then everything misses.
class OnceFailingTracer final : public Tracer {
 public:
  bool observes_shaders() const override { return false; }
  std::unique_ptr<WarpTracer> begin_warp(uint64_t) override {
    struct OnceFailing final : WarpTracer {
      bool failed = false;
      void trace(std::span<TraceCall>) override {
        if (!std::exchange(failed, true)) throw std::runtime_error("once");
      }
    };
    return std::make_unique<OnceFailing>();
  }
  void end_warp(uint64_t, std::unique_ptr<WarpTracer>) override {}
};
}  // namespace

TEST_CASE("lanes that catch a tracer's failure may go on tracing") {
  constexpr uint lanes = 40;
  Program program;
  const RaytracingAccelerationStructure scene = masked_layers(program);
  const Buffer log = program.counters(lanes);
  const auto out = log.rw_structured<uint>();
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    Value payload{0};
    uint caught = 0;
    for (uint i = 0; i < 3; ++i) {
      try {
        ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
      } catch (const std::runtime_error&) {
        ++caught;
      }
    }
    out[ctx.DispatchRaysIndex().x] = caught + payload.value;
  });
  program.create("rg", {"ms"}, {"hg"});
  OnceFailingTracer tracer;
  DispatchOptions options = options_of(16);
  options.tracer = &tracer;
  program.run(lanes, 1, 1, options);
  for (uint lane = 0; lane < lanes; ++lane) CHECK(log.as<uint>()[lane] == 1 + 2 * missed);
}
