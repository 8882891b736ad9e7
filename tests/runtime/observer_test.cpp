// The seam to the hardware model: what an observing tracer is told, in order.

#include "program.h"

#include <rayloom/base/parallel.h>
#include <rayloom/runtime/native_tracer.h>

#include <catch2/catch.hpp>
#include <mutex>

using namespace rayloom;
using namespace rayloom::test;

namespace {

/// Writes down what it is told, and traces as the native tracer does.
class NotingTracer final : public Tracer {
 public:
  class Warp final : public WarpTracer {
   public:
    Warp(NotingTracer& owner, std::unique_ptr<WarpTracer> native) : owner_(owner), native_(std::move(native)) {}
    void trace(std::span<TraceCall> calls) override {
      std::string lanes;
      for (const TraceCall& call : calls) lanes += " " + std::to_string(call.lane);
      note("trace" + lanes);
      native_->trace(calls);
    }
    void begin_shader(uint32_t lane, uint32_t shader, uint64_t record) override {
      note("begin " + std::to_string(lane) + " " + owner_.names[shader] + (record % 32 == 0 && record ? "" : " ?"));
    }
    void end_shader(uint32_t lane) override { note("end " + std::to_string(lane)); }
    void access(uint32_t lane, AccessKind kind, uint64_t address, uint32_t bytes, const void* data) override {
      note((kind == AccessKind::load ? "load " : "store ") + std::to_string(lane) + " " +
           std::to_string(address - owner_.base) + " " + std::to_string(bytes) +
           (data && bytes == 4 ? " = " + std::to_string(*static_cast<const uint*>(data)) : ""));
    }
    void branch(uint32_t lane, uint32_t signature) override {
      note("branch " + std::to_string(lane) + " " + std::to_string(signature));
    }
    void call_shader(uint32_t lane, uint32_t bytes) override {
      note("call " + std::to_string(lane) + " " + std::to_string(bytes));
    }

    std::vector<std::string> events;
    std::unique_ptr<WarpTracer> native() { return std::move(native_); }

   private:
    void note(std::string event) { events.push_back(std::move(event)); }
    NotingTracer& owner_;
    std::unique_ptr<WarpTracer> native_;
  };

  bool observes_shaders() const override { return true; }
  void begin_dispatch(const DispatchInfo& info) override {
    for (const ShaderInfo& shader : info.shaders) names.push_back(shader.name);
    size = {info.width, info.height, info.depth, info.warp_size, uint32_t(info.warp_count)};
    events.resize(info.warp_count);
    native_.begin_dispatch(info);
  }
  std::unique_ptr<WarpTracer> begin_warp(uint64_t warp) override {
    return std::make_unique<Warp>(*this, native_.begin_warp(warp));
  }
  void end_warp(uint64_t warp, std::unique_ptr<WarpTracer> tracer) override {
    const std::lock_guard lock(mutex_);
    events[warp] = static_cast<Warp&>(*tracer).events;
    ++ended;
  }
  void end_dispatch() override { finished = true; }

  uint64_t base = 0;
  std::vector<std::string> names;
  std::vector<uint32_t> size;
  std::vector<std::vector<std::string>> events;
  uint64_t ended = 0;
  bool finished = false;

 private:
  NativeTracer native_;
  std::mutex mutex_;
};

}  // namespace

TEST_CASE("an observing tracer sees shaders, accesses, branches, calls and batches of both lanes") {
  Program program;
  const Buffer log = program.counters();
  const auto out = log.rw_structured<uint>();
  const auto scene = program.scene(program.layers({1}, {RAYTRACING_GEOMETRY_FLAG_NONE}));
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    const uint x = ctx.DispatchRaysIndex().x;
    Value payload{out.Load(x)};
    ctx.Branch(5 + x);
    ctx.TraceRay(x == 0 ? scene : RaytracingAccelerationStructure{}, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
    out[x] = 9;
  });
  program.shaders.AnyHit("ah", [=](AnyHitContext& ctx, Value&, const Barycentrics&) {
    out[8] = 1;
    return ctx.AcceptHit();
  });
  program.shaders.ClosestHit("ch", [=](ClosestHitContext&, Value&, const Barycentrics&) { out[9] = 2; });
  program.shaders.Miss("ms", [](MissContext& ctx, Value& payload) { ctx.CallShader(0, payload); });
  program.shaders.Callable("ca", [=](CallableContext&, Value&) { InterlockedAdd(out[10], 3); });
  program.hit_group("hg", "ch", "ah");
  program.create("rg", {"ms"}, {"hg"}, {"ca"});
  NotingTracer tracer;
  tracer.base = log.address();
  DispatchOptions options;
  options.tracer = &tracer;
  program.run(2, 1, 1, options);
  CHECK(tracer.finished);
  CHECK(tracer.size == std::vector<uint32_t>{2, 1, 1, 32, 1});
  CHECK(tracer.events.at(0) == std::vector<std::string>{"begin 0 rg",  "load 0 0 4",       "branch 0 5",
                                                        "begin 1 rg",  "load 1 4 4",       "branch 1 6",
                                                        "trace 0 1",   "begin 0 ah",       "store 0 32 4 = 1",
                                                        "end 0",       "begin 0 ch",       "store 0 36 4 = 2",
                                                        "end 0",       "store 0 0 4 = 9",  "end 0",
                                                        "begin 1 ms",  "call 1 4",         "begin 1 ca",
                                                        "load 1 40 4", "store 1 40 4 = 3", "end 1",
                                                        "end 1",       "store 1 4 4 = 9",  "end 1"});
}

TEST_CASE("what is observed is the same for any thread count, and every warp is ended") {
  std::vector<std::vector<std::string>> expected;
  for (const unsigned threads : {1u, 3u}) {
    Program program;
    const Buffer log = program.counters(1024);
    const auto out = log.rw_structured<uint>();
    const auto scene = program.scene(program.layers({1}));
    program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
      Value payload{0};
      ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
      out[ctx.DispatchRaysIndex().x] = payload.value;
    });
    program.shaders.ClosestHit("ch", [](ClosestHitContext& ctx, Value& payload, const Barycentrics&) {
      payload.value = ctx.DispatchRaysIndex().x;
    });
    program.hit_group("hg", "ch");
    program.create("rg", {""}, {"hg"});
    NotingTracer tracer;
    tracer.base = log.address();
    DispatchOptions options;
    options.tracer = &tracer;
    options.warp_size = 20;
    const ThreadLimit limit(threads);
    program.run(1000, 1, 1, options);
    CHECK(tracer.ended == 50);
    if (expected.empty()) expected = tracer.events;
    CHECK(tracer.events == expected);
  }
}
