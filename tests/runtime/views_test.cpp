#include <rayloom/runtime/rayloom.h>

#include <catch2/catch.hpp>

using namespace rayloom;

namespace {
struct Item {
  float3 position;
  uint id;
};
}  // namespace

TEST_CASE("views load and store inside their bounds") {
  Device device;
  const ShaderMemoryScope scope(device);
  const Buffer buffer = device.create_buffer(4 * sizeof(Item));
  const auto items = buffer.rw_structured<Item>();
  items[2] = {float3(1, 2, 3), 9};
  CHECK(items.Load(2).id == 9);
  CHECK(buffer.as<Item>()[2].position == float3(1, 2, 3));
  items[3] = items[2];
  CHECK(buffer.as<Item>()[3].id == 9);
  CHECK(buffer.structured<Item>()[3].position.z == 3);
}

TEST_CASE("out of bounds loads are zero and stores are dropped") {
  Device device;
  const ShaderMemoryScope scope(device);
  const Buffer buffer = device.upload(std::vector<uint>{1, 2, 3, 4});
  const RWStructuredBuffer<uint> half{buffer.address(), 2};
  half[2] = 99;
  CHECK(buffer.as<uint>()[2] == 3);
  CHECK(half.Load(2) == 0);
  const RWTexture2D<uint> texture = buffer.rw_texture<uint>(2, 2);
  texture[uint2(2, 0)] = 99;  // not the first texel of the next row
  CHECK(buffer.as<uint>()[2] == 3);
  CHECK(texture.Load(uint2(1, 1)) == 4);
  CHECK(texture.Load(uint2(0, 2)) == 0);
  const ByteAddressBuffer bytes{buffer.address(), 16};
  CHECK(bytes.Load2(8) == uint2(3, 4));
  CHECK(bytes.Load2(12) == uint2(0, 0));
  CHECK(bytes.Load(~uint64_t{0}) == 0);
}

TEST_CASE("a view of memory that is not there never crashes") {
  Device device;
  const ShaderMemoryScope scope(device);
  for (const uint64_t address :
       {uint64_t{0}, uint64_t{16}, DeviceMemory::first_address + (uint64_t{1} << 30), ~uint64_t{3}}) {
    const RWStructuredBuffer<uint> view{address, ~uint64_t{0}};
    view[0] = 1;
    view[123456789] = 1;
    CHECK(view.Load(0) == 0);
    CHECK(ConstantBuffer<Item> { address } -> id == 0);
    InterlockedAdd(view[1], 1);
  }
}

TEST_CASE("an element straddling the end of committed memory is out of bounds") {
  Device device;
  const ShaderMemoryScope scope(device);
  const Buffer buffer = device.create_buffer(DeviceMemory::page_bytes);
  const RWByteAddressBuffer bytes{{buffer.address(), 2 * DeviceMemory::page_bytes}};
  bytes.Store(DeviceMemory::page_bytes - 4, uint4(1));
  CHECK(bytes.Load(DeviceMemory::page_bytes - 4) == 0);
}

TEST_CASE("outside of a dispatch views reach nothing") {
  Device device;
  const Buffer buffer = device.upload(std::vector<uint>{5});
  CHECK(buffer.structured<uint>()[0] == 0);
}

TEST_CASE("interlocked operations return the value before") {
  Device device;
  const ShaderMemoryScope scope(device);
  const Buffer buffer = device.upload(std::vector<uint>{5, 5, 5, 5, 5, 5, 5, 5});
  const auto view = buffer.rw_structured<uint>();
  CHECK(InterlockedAdd(view[0], 3) == 5);
  CHECK(InterlockedMin(view[1], 3) == 5);
  CHECK(InterlockedMax(view[2], 8) == 5);
  CHECK(InterlockedAnd(view[3], 4) == 5);
  CHECK(InterlockedOr(view[4], 2) == 5);
  CHECK(InterlockedXor(view[5], 1) == 5);
  CHECK(InterlockedExchange(view[6], 1) == 5);
  CHECK(InterlockedCompareExchange(view[7], 4, 1) == 5);
  CHECK(InterlockedCompareExchange(view[7], 5, 6) == 5);
  CHECK(buffer.download<uint>(8) == std::vector<uint>{8, 3, 8, 4, 7, 4, 1, 6});
}

TEST_CASE("HLSL matrices: m[r] is a row, bytes are row major, mul is HLSL's") {
  const float bytes[12] = {1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30};
  float3x4 m;
  std::memcpy(&m, bytes, sizeof(m));
  CHECK(m[1] == float4(0, 2, 0, 20));
  CHECK(mul(m, float4(1, 1, 1, 1)) == float3(11, 22, 33));
  CHECK(mul(float4(1, 1, 1, 1), glm::transpose(m)) == float3(11, 22, 33));
  const float3x3 a(float3(1, 2, 3), float3(0, 1, 0), float3(0, 0, 1));
  CHECK(mul(a, float3(1, 1, 1)) == float3(6, 1, 1));
  CHECK(mul(float3(1, 1, 1), a) == float3(1, 3, 4));
}
