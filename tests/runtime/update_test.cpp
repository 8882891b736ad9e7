// Rows UP, BF-01, BF-06, BI-23, RW-17: structures updated by commands, between the dispatches or traces that use them.

#include "program.h"

#include <rayloom/accel/trace.h>
#include <rayloom/base/error.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using Catch::Matchers::Contains;

namespace {

constexpr auto updatable = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_ALLOW_UPDATE;
constexpr auto updating = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS(
    updatable | RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PERFORM_UPDATE);

/// A triangle over the origin, perpendicular to z.
std::vector<float> triangle_at(float z) { return {-1, -1, z, 0, 2, z, 1, -1, z}; }

/// One triangle in one instance, each level in a structure that may be updated.
struct UpdatableScene {
  Device device;
  Buffer vertices = device.upload(triangle_at(1));
  RAYTRACING_GEOMETRY_DESC geometry = triangle_geometry(vertices, 3);
  AccelerationStructure bottom = build_bottom_level(device, std::span(&geometry, 1), updatable);
  RAYTRACING_INSTANCE_DESC desc = instance(bottom);
  AccelerationStructure top = build_top_level(device, std::span(&desc, 1), updatable);
  Buffer descs = device.upload(std::span<const RAYTRACING_INSTANCE_DESC>(&desc, 1));

  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS bottom_inputs() const {
    BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
    inputs.Type = RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL;
    inputs.Flags = updating;
    inputs.NumDescs = 1;
    inputs.pGeometryDescs = &geometry;
    return inputs;
  }
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS top_inputs() const {
    BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
    inputs.Flags = updating;
    inputs.NumDescs = 1;
    inputs.InstanceDescs = descs.address();
    return inputs;
  }
  void update(const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS& inputs, uint64_t source, uint64_t destination) {
    CommandList list;
    list.BuildRaytracingAccelerationStructure({destination, inputs, source});
    device.execute(list);
  }
  /// Distance along +z from z = -1; 100 for a miss.
  float distance(const Buffer& structure) const {
    accel::TraceRequest request;
    request.ray = {{0, 0, -1}, 0, {0, 0, 1}, 100};
    request.structure = structure.host().data();
    return accel::trace(device.addresses(), request).t;
  }
};

}  // namespace

TEST_CASE("UP-01, UP-02, UP-05: both levels updated in place by one command list") {
  UpdatableScene scene;
  CHECK(scene.distance(scene.top.buffer()) == 2);
  const Buffer moved = scene.device.upload(triangle_at(4));
  CommandList list;
  list.CopyBufferRegion(scene.vertices, 0, moved, 0, 36);
  list.BuildRaytracingAccelerationStructure({scene.bottom.address(), scene.bottom_inputs(), scene.bottom.address()});
  list.BuildRaytracingAccelerationStructure({scene.top.address(), scene.top_inputs(), scene.top.address()});
  scene.device.execute(list);
  CHECK(scene.distance(scene.top.buffer()) == 5);
}

TEST_CASE("UP-01, UP-06: an update elsewhere, from other buffers, leaves the source alone") {
  UpdatableScene scene;
  const Buffer moved = scene.device.upload(triangle_at(6));
  scene.geometry = triangle_geometry(moved, 3);
  const Buffer result = scene.device.create_buffer(scene.bottom.bytes());
  scene.update(scene.bottom_inputs(), scene.bottom.address(), result.address());
  CHECK(scene.distance(scene.bottom.buffer()) == 2);
  CHECK(scene.distance(result) == 7);
}

TEST_CASE("UP-05: an update of the top level may move an instance") {
  UpdatableScene scene;
  scene.desc.Transform[2][3] = 9;
  scene.descs.upload(std::span<const RAYTRACING_INSTANCE_DESC>(&scene.desc, 1));
  scene.update(scene.top_inputs(), scene.top.address(), scene.top.address());
  CHECK(scene.distance(scene.top.buffer()) == 11);
}

TEST_CASE("UP-04: procedural boxes are updated") {
  Device device;
  const Buffer boxes = device.upload(std::vector<float>{-1, -1, 1, 1, 1, 2});
  const RAYTRACING_GEOMETRY_DESC geometry = aabb_geometry(boxes, 1);
  const AccelerationStructure bottom = build_bottom_level(device, std::span(&geometry, 1), updatable);
  boxes.upload(std::span<const float>(std::vector<float>{-1, -1, 5, 1, 1, 7}));
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS inputs;
  inputs.Type = RAYTRACING_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL;
  inputs.Flags = updating;
  inputs.NumDescs = 1;
  inputs.pGeometryDescs = &geometry;
  CommandList list;
  list.BuildRaytracingAccelerationStructure({bottom.address(), inputs, bottom.address()});
  device.execute(list);
  const accel::StructureInfo info = accel::structure_info(bottom.buffer().host().data());
  CHECK(info.bounds_min[2] == 5);
  CHECK(info.bounds_max[2] == 7);
}

TEST_CASE("BF-01, BF-06, BI-22, BI-23, UP-02: what an update refuses") {
  UpdatableScene scene;
  const uint64_t bottom = scene.bottom.address();
  CHECK_THROWS_WITH(scene.update(scene.bottom_inputs(), 0, bottom), Contains("BF-06"));
  CHECK_THROWS_WITH(scene.update(scene.bottom_inputs(), bottom + 128, bottom), Contains("BI-22"));
  CHECK_THROWS_WITH(scene.update(scene.bottom_inputs(), scene.vertices.address(), bottom), Contains("structure"));
  CHECK_THROWS_WITH(scene.update(scene.bottom_inputs(), scene.top.address(), bottom), Contains("UP-02"));
  auto inputs = scene.bottom_inputs();
  inputs.Flags = updatable;
  CHECK_THROWS_WITH(scene.update(inputs, bottom, bottom), Contains("BI-23"));
  inputs.Flags = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS(
      updating | RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_MINIMIZE_MEMORY);
  CHECK_THROWS_WITH(scene.update(inputs, bottom, bottom), Contains("BF-06"));
  inputs.Flags = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PERFORM_UPDATE;
  CHECK_NOTHROW(scene.update(inputs, bottom, bottom));
  CHECK_THROWS_WITH(scene.update(inputs, bottom, bottom), Contains("BF-01"));
}

TEST_CASE("RW-17, PB-05: prebuild sizes are the same for an update, and its scratch is none") {
  UpdatableScene scene;
  auto inputs = scene.bottom_inputs();
  const auto update = scene.device.GetRaytracingAccelerationStructurePrebuildInfo(inputs);
  inputs.Flags = updatable;
  const auto build = scene.device.GetRaytracingAccelerationStructurePrebuildInfo(inputs);
  CHECK(update.ResultDataMaxSizeInBytes == build.ResultDataMaxSizeInBytes);
  CHECK(update.UpdateScratchDataSizeInBytes == 0);
}
