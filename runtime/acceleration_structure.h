#pragma once

// The common case in three lines: geometry, bottom level, top level.
//
//   auto mesh = build_bottom_level(device, {triangle_geometry(vertices, vertex_count, indices, index_count)});
//   auto scene = build_top_level(device, {instance(mesh)});
//   RaytracingAccelerationStructure tlas = scene.view();

#include <rayloom/runtime/device.h>

#include <initializer_list>
#include <span>
#include <vector>

namespace rayloom {

/// A built structure and the memory it lies in. A top level refers to its bottom levels, which must outlive its use.
class AccelerationStructure {
 public:
  AccelerationStructure() = default;
  explicit AccelerationStructure(Buffer buffer) : buffer_(std::move(buffer)) {}

  uint64_t address() const { return buffer_.address(); }
  uint64_t bytes() const { return buffer_.bytes(); }
  RaytracingAccelerationStructure view() const { return {buffer_.address()}; }
  const Buffer& buffer() const { return buffer_; }

 private:
  Buffer buffer_;
};

/// Float3 positions at the start of each `stride` bytes of `vertices`; every three make a triangle.
RAYTRACING_GEOMETRY_DESC triangle_geometry(const Buffer& vertices, uint32_t vertex_count, uint64_t stride = 12,
                                           RAYTRACING_GEOMETRY_FLAGS flags = RAYTRACING_GEOMETRY_FLAG_OPAQUE);
/// The same with an index buffer of 16- or 32-bit indices.
RAYTRACING_GEOMETRY_DESC indexed_geometry(const Buffer& vertices, uint32_t vertex_count, const Buffer& indices,
                                          uint32_t index_count, INDEX_FORMAT format = FORMAT_R32_UINT,
                                          uint64_t stride = 12,
                                          RAYTRACING_GEOMETRY_FLAGS flags = RAYTRACING_GEOMETRY_FLAG_OPAQUE);
RAYTRACING_GEOMETRY_DESC aabb_geometry(const Buffer& boxes, uint64_t count, uint64_t stride = 24,
                                       RAYTRACING_GEOMETRY_FLAGS flags = RAYTRACING_GEOMETRY_FLAG_OPAQUE);

/// Sets what most programs leave alone; change the fields of the result.
RAYTRACING_INSTANCE_DESC instance(const AccelerationStructure& bottom_level);
RAYTRACING_INSTANCE_DESC instance(const AccelerationStructure& bottom_level, const float3x4& object_to_world);

AccelerationStructure build_bottom_level(
    Device& device, std::span<const RAYTRACING_GEOMETRY_DESC> geometries,
    RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_NONE);
AccelerationStructure build_top_level(
    Device& device, std::span<const RAYTRACING_INSTANCE_DESC> instances,
    RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_NONE);

inline AccelerationStructure build_bottom_level(Device& device,
                                                std::initializer_list<RAYTRACING_GEOMETRY_DESC> geometries) {
  return build_bottom_level(device, std::span(geometries.begin(), geometries.size()));
}
inline AccelerationStructure build_top_level(Device& device,
                                             std::initializer_list<RAYTRACING_INSTANCE_DESC> instances) {
  return build_top_level(device, std::span(instances.begin(), instances.size()));
}

}  // namespace rayloom
