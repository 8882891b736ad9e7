// The layout checks are compile-time; this converts values both ways.

#include <catch2/catch.hpp>

// After Catch: the real headers define macros that other headers stumble over.
#include <rayloom/runtime/d3d12_interop.h>

using namespace rayloom;

TEST_CASE("dispatch and instance descs survive the way to d3d12.h and back, member by member") {
  DISPATCH_RAYS_DESC ours;
  ours.HitGroupTable = {0x1000, 640, 64};
  ours.Width = 7;
  ours.Depth = 9;
  const D3D12_DISPATCH_RAYS_DESC theirs = interop::to_d3d12(ours);
  CHECK(theirs.HitGroupTable.StartAddress == 0x1000);
  CHECK(theirs.HitGroupTable.StrideInBytes == 64);
  CHECK(theirs.Width == 7);
  CHECK(interop::from_d3d12<DISPATCH_RAYS_DESC>(theirs).Depth == 9);

  D3D12_RAYTRACING_INSTANCE_DESC instance{};
  instance.Transform[1][3] = 5;
  instance.InstanceID = 0xABCDEF;
  instance.InstanceMask = 0x12;
  instance.InstanceContributionToHitGroupIndex = 0x123456;
  instance.Flags = D3D12_RAYTRACING_INSTANCE_FLAG_FORCE_OPAQUE;
  instance.AccelerationStructure = 256;
  const auto converted = interop::from_d3d12<RAYTRACING_INSTANCE_DESC>(instance);
  CHECK(converted.Transform[1][3] == 5);
  CHECK(converted.InstanceID == 0xABCDEF);
  CHECK(converted.InstanceMask == 0x12);
  CHECK(converted.InstanceContributionToHitGroupIndex == 0x123456);
  CHECK(converted.Flags == RAYTRACING_INSTANCE_FLAG_FORCE_OPAQUE);
  CHECK(converted.AccelerationStructure == 256);
}

TEST_CASE("geometry descs and build inputs keep their unions") {
  D3D12_RAYTRACING_GEOMETRY_DESC geometry{};
  geometry.Type = D3D12_RAYTRACING_GEOMETRY_TYPE_PROCEDURAL_PRIMITIVE_AABBS;
  geometry.AABBs.AABBCount = 3;
  geometry.AABBs.AABBs.StrideInBytes = 32;
  const auto ours = interop::from_d3d12<RAYTRACING_GEOMETRY_DESC>(geometry);
  CHECK(ours.Type == RAYTRACING_GEOMETRY_TYPE_PROCEDURAL_PRIMITIVE_AABBS);
  CHECK(ours.AABBs.AABBCount == 3);
  CHECK(ours.AABBs.AABBs.StrideInBytes == 32);
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_DESC build;
  build.Inputs.NumDescs = 4;
  build.Inputs.InstanceDescs = 0x4000;
  const auto theirs = interop::to_d3d12(build);
  CHECK(theirs.Inputs.NumDescs == 4);
  CHECK(theirs.Inputs.InstanceDescs == 0x4000);
}
