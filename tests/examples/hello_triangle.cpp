// The smallest whole DXR program: one triangle, one ray a pixel, barycentrics as colours.

#include <rayloom/runtime/rayloom.h>

#include <cstdio>
#include <vector>

using namespace rayloom;

// ---- the shaders ----

struct Payload {
  float4 color;
  float hitDistance;
};

// An orthographic camera that looks along +z at the square [-1, 1] x [-1, 1].
RayDesc camera_ray(uint3 index, uint3 dimensions) {
  const float2 pixel = float2(float(index.x) + 0.5f, float(index.y) + 0.5f);
  const float2 screen = pixel / float2(float(dimensions.x), float(dimensions.y)) * 2.0f - 1.0f;
  return {float3(screen.x, -screen.y, -1), 0.001f, float3(0, 0, 1), 10000.0f};
}

struct RayGenMain {
  RaytracingAccelerationStructure scene;
  RWTexture2D<float4> output;

  void operator()(RayGenContext& ctx) const {
    RayDesc ray = camera_ray(ctx.DispatchRaysIndex(), ctx.DispatchRaysDimensions());
    Payload payload{};
    ctx.TraceRay(scene, RAY_FLAG_NONE, 0xFF, 0, 1, 0, ray, payload);
    output[ctx.DispatchRaysIndex()] = payload.color;
  }
};

void ClosestHitMain(ClosestHitContext& ctx, Payload& payload, const BuiltInTriangleIntersectionAttributes& attr) {
  float2 b = attr.barycentrics;
  payload = {float4(b.x, b.y, 1 - b.x - b.y, 1), ctx.RayTCurrent()};
}

void MissMain(MissContext&, Payload& payload) { payload = {float4(0, 0, 0, 0), -1}; }

// ---- the program ----

int main() {
  constexpr uint size = 64;
  Device device;
  Buffer picture = device.create_buffer(size * size * sizeof(float4));

  // Geometry, bottom level, top level.
  Buffer vertices = device.upload(std::vector<float3>{{-0.75f, -0.75f, 0}, {0, 0.75f, 0}, {0.75f, -0.75f, 0}});
  AccelerationStructure mesh = build_bottom_level(device, {triangle_geometry(vertices, 3)});
  AccelerationStructure scene = build_top_level(device, {instance(mesh)});

  // Shaders, hit group, limits.
  ShaderLibrary library;
  library.RayGeneration("RayGenMain", RayGenMain{scene.view(), picture.rw_texture<float4>(size, size)});
  library.ClosestHit("ClosestHitMain", ClosestHitMain);
  library.Miss("MissMain", MissMain);
  STATE_OBJECT_DESC desc;
  desc.add(DXIL_LIBRARY_DESC{library});
  desc.add(HIT_GROUP_DESC{.HitGroupExport = "HitGroup", .ClosestHitShaderImport = "ClosestHitMain"});
  desc.add(RAYTRACING_SHADER_CONFIG{.MaxPayloadSizeInBytes = sizeof(Payload)});
  desc.add(RAYTRACING_PIPELINE_CONFIG{.MaxTraceRecursionDepth = 1});
  auto pipeline = device.CreateStateObject(desc);

  // Shader tables, one record each.
  ShaderTable ray_generation = ShaderTableBuilder(*pipeline).add("RayGenMain").build(device);
  ShaderTable miss = ShaderTableBuilder(*pipeline).add("MissMain").build(device);
  ShaderTable hit_groups = ShaderTableBuilder(*pipeline).add("HitGroup").build(device);

  CommandList list;
  list.SetPipelineState1(pipeline);
  list.DispatchRays({ray_generation, miss, hit_groups, {}, size, size, 1});
  const ExecutionReport report = device.execute(list);

  const std::span<const float4> pixels = picture.as<float4>();
  for (uint y = 0; y < size; y += 4) {
    for (uint x = 0; x < size; x += 2) {
      const float4 color = pixels[y * size + x];
      std::putchar(color.w == 0 ? '.'
                                : "rgb"[color.x > color.y ? (color.x > color.z ? 0 : 2) : (color.y > color.z ? 1 : 2)]);
    }
    std::putchar('\n');
  }
  const float4 centre = pixels[size / 2 * size + size / 2];
  std::printf("centre %.6f %.6f %.6f\n", double(centre.x), double(centre.y), double(centre.z));

  // The triangle covers 9/32 of the picture; its weights sum to one.
  uint64_t covered = 0;
  for (const float4& color : pixels) covered += color.w == 1;
  const DispatchStatistics& counts = report.dispatches[0].statistics;
  const bool good = counts.rays == size * size && counts.closest_hit == covered &&
                    counts.miss == size * size - covered && covered > 1100 && covered < 1200 &&
                    centre.x + centre.y + centre.z == 1.0f;
  std::printf("%llu of %u pixels hit: %s\n", static_cast<unsigned long long>(covered), size * size,
              good ? "ok" : "WRONG");
  return good ? 0 : 1;
}
