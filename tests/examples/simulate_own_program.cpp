// One's own DXR program on the simulated GPU: a wavy sheet of triangles in the light of a lamp, with shadow rays.
// Any DispatchRays can be captured like this: the program itself does not change.

#include <rayloom/hwmodel/recording_tracer.h>
#include <rayloom/hwmodel/report.h>
#include <rayloom/runtime/rayloom.h>

#include <cstdio>
#include <cstring>
#include <vector>

using namespace rayloom;

struct Payload {
  float brightness;
};
constexpr uint size = 128, cells = 48;

struct RayGen {
  RaytracingAccelerationStructure scene;
  RWTexture2D<float> output;
  void operator()(RayGenContext& ctx) const {
    const uint3 index = ctx.DispatchRaysIndex();
    const float x = (float(index.x) + 0.5f) / size * 2 - 1, y = (float(index.y) + 0.5f) / size * 2 - 1;
    Payload payload{0};
    ctx.TraceRay(scene, RAY_FLAG_NONE, 0xFF, 0, 1, 0, {float3(0, 1.5f, -2), 0, float3(x, -0.6f - y, 2), 100}, payload);
    output[uint2(index)] = payload.brightness;
  }
};

// The lamp hangs at (0, 2, 0); what it does not see lies in shadow.
struct Shade {
  RaytracingAccelerationStructure scene;
  void operator()(ClosestHitContext& ctx, Payload& payload, const BuiltInTriangleIntersectionAttributes&) const {
    const float3 point = ctx.WorldRayOrigin() + ctx.RayTCurrent() * ctx.WorldRayDirection();
    Payload shadow{0};
    const uint flags = RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH | RAY_FLAG_SKIP_CLOSEST_HIT_SHADER;
    ctx.TraceRay(scene, flags, 0xFF, 0, 1, 1, {point, 0.001f, float3(0, 2, 0) - point, 1}, shadow);
    payload.brightness = 0.1f + shadow.brightness;
  }
};

std::vector<float3> wavy_sheet() {
  std::vector<float3> corners;
  const auto corner = [](uint x, uint z) {
    const float height = 0.15f * float((x * x + 3 * z) % 5) / 4;
    return float3(float(x) / cells * 4 - 2, height, float(z) / cells * 4 - 2);
  };
  for (uint z = 0; z < cells; ++z)
    for (uint x = 0; x < cells; ++x)
      for (const uint2 d : {uint2(0, 0), uint2(1, 0), uint2(0, 1), uint2(1, 1), uint2(0, 1), uint2(1, 0)})
        corners.push_back(corner(x + d.x, z + d.y));
  return corners;
}

int main() {
  // The program, as one would write it for native execution.
  Device device;
  const std::vector<float3> corners = wavy_sheet();
  const Buffer picture = device.create_buffer(size * size * sizeof(float));
  const Buffer vertices = device.upload(corners);
  const AccelerationStructure mesh = build_bottom_level(device, {triangle_geometry(vertices, uint(corners.size()))});
  const AccelerationStructure scene = build_top_level(device, {instance(mesh)});
  ShaderLibrary library;
  library.RayGeneration("RayGen", RayGen{scene.view(), picture.rw_texture<float>(size, size)}, {.cost = {40, 2}});
  library.ClosestHit("Shade", Shade{scene.view()}, {.cost = {30, 1}});
  library.Miss("Sky", [](MissContext&, Payload& payload) { payload.brightness = 0.5f; }, {.cost = {4}});
  library.Miss("Lit", [](MissContext&, Payload& payload) { payload.brightness = 0.9f; }, {.cost = {2}});
  STATE_OBJECT_DESC desc;
  desc.add(DXIL_LIBRARY_DESC{library});
  desc.add(HIT_GROUP_DESC{.HitGroupExport = "HitGroup", .ClosestHitShaderImport = "Shade"});
  desc.add(RAYTRACING_SHADER_CONFIG{.MaxPayloadSizeInBytes = sizeof(Payload)});
  desc.add(RAYTRACING_PIPELINE_CONFIG{.MaxTraceRecursionDepth = 2});
  const auto pipeline = device.CreateStateObject(desc);
  const ShaderTable ray_generation = ShaderTableBuilder(*pipeline).add("RayGen").build(device);
  const ShaderTable miss = ShaderTableBuilder(*pipeline).add("Sky").add("Lit").build(device);
  const ShaderTable hit_groups = ShaderTableBuilder(*pipeline).add("HitGroup").build(device);
  CommandList list;
  list.SetPipelineState1(pipeline);
  list.DispatchRays({ray_generation, miss, hit_groups, {}, size, size, 1});

  // Natively; then once more, captured.
  device.execute(list);
  const std::vector<float> native = picture.download<float>(size * size);
  hwmodel::RecordingTracer recorder;
  device.execute(list, {.tracer = &recorder});

  // On the simulated GPU, with two parameters changed. It computes the picture again and must come to the same.
  hwmodel::GpuPreset gpu = hwmodel::make_preset("turing");
  hwmodel::set_parameter(gpu, "sm.count=4");
  hwmodel::set_parameter(gpu, "rt.warp_entries=8");
  const hwmodel::ReplayResult result = hwmodel::replay(recorder.captures(), gpu.config);
  std::vector<float> simulated(size * size);
  result.memory.read(picture.address(), std::as_writable_bytes(std::span(simulated)));

  std::fputs(hwmodel::report_text(result.stats).c_str(), stdout);
  uint64_t busiest = 0;
  for (const uint64_t cycles : result.pixel_cycles.at(0)) busiest = std::max(busiest, cycles);
  std::printf("busiest pixel: %llu clocks\n", static_cast<unsigned long long>(busiest));
  const bool same = std::memcmp(native.data(), simulated.data(), native.size() * sizeof(float)) == 0;
  std::printf("simulated picture equals native picture: %s\n", same ? "yes" : "NO");
  return same ? 0 : 1;
}
