#include <rayloom/runtime/acceleration_structure.h>

#include <cstring>

namespace rayloom {
namespace {

using BuildFlags = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS;

AccelerationStructure build(Device& device, const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS& inputs) {
  const auto sizes = device.GetRaytracingAccelerationStructurePrebuildInfo(inputs);
  Buffer result = device.create_buffer(sizes.ResultDataMaxSizeInBytes);
  CommandList list;
  list.BuildRaytracingAccelerationStructure({result.address(), inputs});
  device.execute(list);
  return AccelerationStructure(std::move(result));
}

}  // namespace

RAYTRACING_GEOMETRY_DESC triangle_geometry(const Buffer& vertices, uint32_t vertex_count, uint64_t stride,
                                           RAYTRACING_GEOMETRY_FLAGS flags) {
  RAYTRACING_GEOMETRY_DESC desc;
  desc.Flags = flags;
  desc.Triangles = {0, FORMAT_UNKNOWN, FORMAT_R32G32B32_FLOAT, 0, vertex_count, 0, {vertices.address(), stride}};
  return desc;
}

RAYTRACING_GEOMETRY_DESC indexed_geometry(const Buffer& vertices, uint32_t vertex_count, const Buffer& indices,
                                          uint32_t index_count, INDEX_FORMAT format, uint64_t stride,
                                          RAYTRACING_GEOMETRY_FLAGS flags) {
  RAYTRACING_GEOMETRY_DESC desc = triangle_geometry(vertices, vertex_count, stride, flags);
  desc.Triangles.IndexFormat = format;
  desc.Triangles.IndexCount = index_count;
  desc.Triangles.IndexBuffer = indices.address();
  return desc;
}

RAYTRACING_GEOMETRY_DESC aabb_geometry(const Buffer& boxes, uint64_t count, uint64_t stride,
                                       RAYTRACING_GEOMETRY_FLAGS flags) {
  RAYTRACING_GEOMETRY_DESC desc;
  desc.Type = RAYTRACING_GEOMETRY_TYPE_PROCEDURAL_PRIMITIVE_AABBS;
  desc.Flags = flags;
  desc.AABBs = {count, {boxes.address(), stride}};
  return desc;
}

RAYTRACING_INSTANCE_DESC instance(const AccelerationStructure& bottom_level) {
  return instance(bottom_level, float3x4(1.0f));
}

RAYTRACING_INSTANCE_DESC instance(const AccelerationStructure& bottom_level, const float3x4& object_to_world) {
  RAYTRACING_INSTANCE_DESC desc{};
  std::memcpy(desc.Transform, &object_to_world, sizeof(desc.Transform));
  desc.InstanceMask = 0xFF;
  desc.AccelerationStructure = bottom_level.address();
  return desc;
}

AccelerationStructure build_bottom_level(Device& device, std::span<const RAYTRACING_GEOMETRY_DESC> geometries,
                                         BuildFlags flags) {
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
  inputs.Type = RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL;
  inputs.Flags = flags;
  inputs.NumDescs = static_cast<uint32_t>(geometries.size());
  inputs.pGeometryDescs = geometries.data();
  return build(device, inputs);
}

AccelerationStructure build_top_level(Device& device, std::span<const RAYTRACING_INSTANCE_DESC> instances,
                                      BuildFlags flags) {
  const Buffer descs = device.upload(instances);
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
  inputs.Flags = flags;
  inputs.NumDescs = static_cast<uint32_t>(instances.size());
  inputs.InstanceDescs = descs.address();
  return build(device, inputs);
}

}  // namespace rayloom
