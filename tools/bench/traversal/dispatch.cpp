#include <rayloom/tools/bench/traversal/dispatch.h>

#include <rayloom/base/parallel.h>
#include <rayloom/runtime/rayloom.h>
#include <rayloom/runtime/tracer.h>

#include <algorithm>
#include <cstring>

namespace rayloom::bench {
namespace {

struct Answer {
  float t, u, v;
  uint32_t instance, primitive, kind;
};
struct Payload {
  Answer answer;
};
using Barycentrics = BuiltInTriangleIntersectionAttributes;

constexpr uint32_t miss_kind = 0;

/// Gives every lane the hit of an earlier run, or a miss where there was none.
class StoredTracer final : public Tracer {
 public:
  std::vector<accel::Hit> hits;  ///< empty: all miss

  bool observes_shaders() const override { return false; }
  void begin_dispatch(const DispatchInfo& info) override { warp_size_ = info.warp_size; }
  std::unique_ptr<WarpTracer> begin_warp(uint64_t warp) override {
    return std::make_unique<Warp>(hits, warp * warp_size_);
  }
  void end_warp(uint64_t, std::unique_ptr<WarpTracer>) override {}

 private:
  class Warp final : public WarpTracer {
   public:
    Warp(const std::vector<accel::Hit>& hits, uint64_t first) : hits_(hits), first_(first) {}
    void trace(std::span<TraceCall> calls) override {
      for (TraceCall& call : calls) call.hit = hits_.empty() ? accel::Hit{} : hits_[first_ + call.lane];
    }

   private:
    const std::vector<accel::Hit>& hits_;
    uint64_t first_;
  };

  uint32_t warp_size_ = 32;
};

RayDesc ray_desc(const accel::Ray& ray) {
  return {float3(ray.origin[0], ray.origin[1], ray.origin[2]), ray.t_min,
          float3(ray.direction[0], ray.direction[1], ray.direction[2]), ray.t_max};
}

}  // namespace

struct DispatchBench::State {
  Device device;
  std::vector<Buffer> buffers;
  std::vector<AccelerationStructure> structures;
  Buffer rays, answers;
  size_t count = 0;
  std::shared_ptr<const StateObject> pipeline;
  std::vector<ShaderTable> tables;
  DISPATCH_RAYS_DESC launch, bare, full;
  StoredTracer misses, stored;

  void build(const BenchScene& scene);
  void create_pipeline();
  ShaderTable table(const std::string& name);
};

void DispatchBench::State::build(const BenchScene& scene) {
  std::vector<RAYTRACING_INSTANCE_DESC> instances;
  for (const BenchMesh& mesh : scene.meshes) {
    buffers.push_back(device.upload(mesh.vertices));
    buffers.push_back(device.upload(mesh.indices));
    const RAYTRACING_GEOMETRY_DESC geometry = indexed_geometry(buffers.end()[-2], mesh.vertex_count(), buffers.back(),
                                                               static_cast<uint32_t>(mesh.indices.size()));
    structures.push_back(build_bottom_level(device, std::span(&geometry, 1),
                                            RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PREFER_FAST_TRACE));
  }
  if (!scene.two_level()) instances.push_back(instance(structures[0]));
  for (const PeerInstance& placed : scene.instances) {
    RAYTRACING_INSTANCE_DESC desc = instance(structures[placed.mesh]);
    std::memcpy(desc.Transform, placed.transform.data(), sizeof desc.Transform);
    instances.push_back(desc);
  }
  structures.push_back(
      build_top_level(device, instances, RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PREFER_FAST_TRACE));
}

ShaderTable DispatchBench::State::table(const std::string& name) {
  ShaderTableBuilder builder(*pipeline);
  name.empty() ? builder.add_null() : builder.add(name);
  return builder.build(device);
}

void DispatchBench::State::create_pipeline() {
  ShaderLibrary shaders;
  const auto scene = structures.back().view();
  const auto in = rays.structured<RayDesc>();
  const auto out = answers.rw_structured<Answer>();
  shaders.RayGeneration("Launch", [in, out](RayGenContext& ctx) {
    const uint index = ctx.DispatchRaysIndex().x;
    out[index] = {in[index].TMax, 0, 0, 0, 0, miss_kind};
  });
  shaders.RayGeneration("Trace", [scene, in, out](RayGenContext& ctx) {
    const uint index = ctx.DispatchRaysIndex().x;
    Payload payload{};
    ctx.TraceRay(scene, RAY_FLAG_NONE, 0xFF, 0, 0, 0, in[index], payload);
    out[index] = payload.answer;
  });
  shaders.ClosestHit("Hit", [](ClosestHitContext& ctx, Payload& payload, const Barycentrics& attributes) {
    payload.answer = {ctx.RayTCurrent(),   attributes.barycentrics.x, attributes.barycentrics.y,
                      ctx.InstanceIndex(), ctx.PrimitiveIndex(),      ctx.HitKind()};
  });
  shaders.Miss("Miss", [](MissContext& ctx, Payload& payload) { payload.answer = {ctx.RayTCurrent(), 0, 0, 0, 0, 0}; });
  STATE_OBJECT_DESC desc;
  desc.add(HIT_GROUP_DESC{"Closest", HIT_GROUP_TYPE_TRIANGLES, "", "Hit", ""});
  desc.add(HIT_GROUP_DESC{"Nothing", HIT_GROUP_TYPE_TRIANGLES, "", "", ""});
  desc.add(DXIL_LIBRARY_DESC{shaders});
  desc.add(RAYTRACING_SHADER_CONFIG{.MaxPayloadSizeInBytes = sizeof(Payload),
                                    .MaxAttributeSizeInBytes = sizeof(Barycentrics)});
  desc.add(RAYTRACING_PIPELINE_CONFIG{.MaxTraceRecursionDepth = 1});
  pipeline = device.CreateStateObject(desc);
  for (const char* name : {"Launch", "Trace", "Nothing", "", "Closest", "Miss"}) tables.push_back(table(name));
  launch.Width = static_cast<uint32_t>(count), launch.Height = launch.Depth = 1;
  bare = full = launch;
  launch.RayGenerationShaderRecord = tables[0];
  bare.RayGenerationShaderRecord = full.RayGenerationShaderRecord = tables[1];
  bare.HitGroupTable = tables[2], bare.MissShaderTable = tables[3];
  full.HitGroupTable = tables[4], full.MissShaderTable = tables[5];
}

DispatchBench::DispatchBench(const BenchScene& scene, const Rays& rays, bool validated)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  if (validated) state.device.set_validation_callback([](const ValidationMessage&) {});
  state.count = rays.size();
  state.build(scene);
  std::vector<RayDesc> descs(rays.size());
  std::transform(rays.begin(), rays.end(), descs.begin(), ray_desc);
  state.rays = state.device.upload(descs);
  state.answers = state.device.create_buffer(rays.size() * sizeof(Answer));
  state.create_pipeline();
  run(DispatchPart::whole);
  state.stored.hits = hits();
}

DispatchBench::~DispatchBench() = default;

void DispatchBench::run(DispatchPart part) {
  State& state = *state_;
  CommandList list;
  list.SetPipelineState1(state.pipeline);
  const bool bare = part == DispatchPart::switches || part == DispatchPart::lookup;
  list.DispatchRays(part == DispatchPart::launch ? state.launch : bare ? state.bare : state.full);
  DispatchOptions options;
  options.mode = ExecutionMode::warp;
  if (part == DispatchPart::switches) options.tracer = &state.misses;
  if (part == DispatchPart::lookup || part == DispatchPart::shaders) options.tracer = &state.stored;
  state.device.execute(list, options);
}

std::vector<accel::Hit> DispatchBench::hits() const {
  std::vector<accel::Hit> hits;
  for (const Answer& answer : state_->answers.as<Answer>().first(state_->count)) {
    accel::Hit& hit = hits.emplace_back();
    hit.t = answer.t;
    if (answer.kind == miss_kind) continue;
    hit.type = accel::HitType::triangle;
    hit.u = answer.u, hit.v = answer.v, hit.hit_kind = answer.kind;
    hit.instance_index = answer.instance, hit.geometry_index = 0, hit.primitive_index = answer.primitive;
  }
  return hits;
}

DispatchBreakdown measure_breakdown(DispatchBench& bench, size_t rays, unsigned threads, uint64_t repetitions) {
  const ThreadLimit limit(threads);
  std::vector<Measurand> measurands;
  for (const DispatchPart part : {DispatchPart::launch, DispatchPart::switches, DispatchPart::lookup,
                                  DispatchPart::shaders, DispatchPart::whole}) {
    measurands.push_back({"", [&bench, part] { bench.run(part); }, static_cast<double>(rays)});
  }
  const Clock clock = threads == 1 ? Clock::thread_cpu : Clock::wall;
  const std::vector<Measured> measured = measure_interleaved(measurands, repetitions, clock);
  const double scale = 1e9 * threads / static_cast<double>(rays);
  double ns[5];
  for (size_t i = 0; i < 5; ++i) ns[i] = measured[i].time().median * scale;
  return {ns[0], ns[1] - ns[0], ns[2] - ns[1], ns[3] - ns[2], ns[4] - ns[3], ns[4]};
}

}  // namespace rayloom::bench
