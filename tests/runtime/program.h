#pragma once

// What the runtime's tests share: a device with its validation messages, shaders, a state object, tables by name, and
// scenes of triangles that all rays of straight_ray() meet.

#include <rayloom/runtime/rayloom.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rayloom::test {

struct NoPayload {};
struct Value {
  uint value = 0;
};
using Barycentrics = BuiltInTriangleIntersectionAttributes;

/// From (x, y, -1) along +z; the plane z = k is at t = k + 1.
inline RayDesc straight_ray(float x = 0, float y = 0) { return {float3(x, y, -1), 0.0f, float3(0, 0, 1), 100.0f}; }

class Program {
 public:
  explicit Program(uint32_t depth = 1) : config{.MaxTraceRecursionDepth = depth} {
    device.set_validation_callback([this](const ValidationMessage& message) { messages.push_back(message); });
  }
  Program(const Program&) = delete;

  Program& hit_group(const std::string& name, const std::string& closest_hit, const std::string& any_hit = "",
                     const std::string& intersection = "") {
    desc.add(HIT_GROUP_DESC{name, intersection.empty() ? HIT_GROUP_TYPE_TRIANGLES : HIT_GROUP_TYPE_PROCEDURAL_PRIMITIVE,
                            any_hit, closest_hit, intersection});
    return *this;
  }

  /// Makes the state object, and tables of the named records ("" is the NULL identifier).
  void create(const std::string& ray_generation, const std::vector<std::string>& miss = {},
              const std::vector<std::string>& hit_groups = {}, const std::vector<std::string>& callables = {}) {
    desc.add(DXIL_LIBRARY_DESC{shaders});
    desc.add(shader_config);
    desc.add(config);
    pipeline = device.CreateStateObject(desc);
    tables.push_back(table({ray_generation}));
    dispatch.RayGenerationShaderRecord = tables.back();
    dispatch.MissShaderTable = keep(miss);
    dispatch.HitGroupTable = keep(hit_groups);
    dispatch.CallableShaderTable = keep(callables);
  }

  ShaderTable table(const std::vector<std::string>& names) {
    ShaderTableBuilder builder(*pipeline);
    for (const std::string& name : names) name.empty() ? builder.add_null() : builder.add(name);
    return builder.build(device);
  }

  DispatchReport run(uint width = 1, uint height = 1, uint depth = 1, const DispatchOptions& options = {}) {
    dispatch.Width = width;
    dispatch.Height = height;
    dispatch.Depth = depth;
    CommandList list;
    list.SetPipelineState1(pipeline);
    list.DispatchRays(dispatch);
    return device.execute(list, options).dispatches.at(0);
  }

  Buffer counters(uint count = 64) { return device.create_buffer(uint64_t{count} * sizeof(uint)); }
  bool reported(std::string_view row) const {
    return std::any_of(messages.begin(), messages.end(), [&](const auto& message) { return message.id == row; });
  }

  /// A front-facing triangle around the z axis at each z, one geometry each.
  const AccelerationStructure& layers(const std::vector<float>& zs, std::vector<RAYTRACING_GEOMETRY_FLAGS> flags = {}) {
    flags.resize(zs.size(), flags.empty() ? RAYTRACING_GEOMETRY_FLAG_OPAQUE : flags.back());
    std::vector<RAYTRACING_GEOMETRY_DESC> geometries;
    for (size_t i = 0; i < zs.size(); ++i) {
      buffers.push_back(device.upload(std::vector<float3>{{-8, -8, zs[i]}, {0, 8, zs[i]}, {8, -8, zs[i]}}));
      geometries.push_back(triangle_geometry(buffers.back(), 3, 12, flags[i]));
    }
    structures.push_back(std::make_unique<AccelerationStructure>(build_bottom_level(device, geometries)));
    return *structures.back();
  }
  /// Boxes [-1, 1] x [-1, 1] x [z, z + 1], one geometry each.
  const AccelerationStructure& boxes(const std::vector<float>& zs,
                                     RAYTRACING_GEOMETRY_FLAGS flags = RAYTRACING_GEOMETRY_FLAG_OPAQUE) {
    std::vector<RAYTRACING_GEOMETRY_DESC> geometries;
    for (const float z : zs) {
      buffers.push_back(device.upload(std::vector<RAYTRACING_AABB>{{-1, -1, z, 1, 1, z + 1}}));
      geometries.push_back(aabb_geometry(buffers.back(), 1, 24, flags));
    }
    structures.push_back(std::make_unique<AccelerationStructure>(build_bottom_level(device, geometries)));
    return *structures.back();
  }
  RaytracingAccelerationStructure scene(const std::vector<RAYTRACING_INSTANCE_DESC>& instances) {
    structures.push_back(std::make_unique<AccelerationStructure>(build_top_level(device, instances)));
    return structures.back()->view();
  }
  RaytracingAccelerationStructure scene(const AccelerationStructure& bottom_level) {
    return scene(std::vector{instance(bottom_level)});
  }

  Device device;
  std::vector<ValidationMessage> messages;
  ShaderLibrary shaders;
  STATE_OBJECT_DESC desc;
  RAYTRACING_SHADER_CONFIG shader_config{.MaxPayloadSizeInBytes = 1024, .MaxAttributeSizeInBytes = 32};
  RAYTRACING_PIPELINE_CONFIG config;
  std::shared_ptr<const StateObject> pipeline;
  DISPATCH_RAYS_DESC dispatch;
  std::vector<ShaderTable> tables;
  std::vector<Buffer> buffers;
  std::vector<std::unique_ptr<AccelerationStructure>> structures;

 private:
  GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE keep(const std::vector<std::string>& names) {
    if (names.empty()) return {};
    tables.push_back(table(names));
    return tables.back();
  }
};

}  // namespace rayloom::test
