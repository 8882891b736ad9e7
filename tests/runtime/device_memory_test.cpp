#include <rayloom/base/error.h>
#include <rayloom/runtime/rayloom.h>

#include <catch2/catch.hpp>

using namespace rayloom;

TEST_CASE("addresses are the same for every device and every run") {
  Device a, b;
  const Buffer a0 = a.create_buffer(100), a1 = a.create_buffer(70000), b0 = b.create_buffer(100);
  CHECK(a0.address() == DeviceMemory::first_address);
  CHECK(b0.address() == DeviceMemory::first_address);
  CHECK(a1.address() == DeviceMemory::first_address + 2 * DeviceMemory::page_bytes);  // a guard page between
  CHECK(a.addresses().host(a1.address()) == a1.host().data());
}

TEST_CASE("freed gaps are used first fit, and come back zeroed") {
  DeviceMemory memory;
  const uint64_t first = memory.allocate(3 * DeviceMemory::page_bytes);
  const uint64_t second = memory.allocate(1);
  memory.host(first)[5] = std::byte{7};
  memory.free(first);
  CHECK_FALSE(memory.holds(first, 1));
  CHECK(memory.allocate(4 * DeviceMemory::page_bytes) > second);  // the gap is one page too small
  CHECK(memory.allocate(3 * DeviceMemory::page_bytes) == first);
  CHECK(memory.host(first)[5] == std::byte{0});
}

TEST_CASE("holds() knows committed ranges to the page") {
  DeviceMemory memory;
  const uint64_t address = memory.allocate(10);
  CHECK(memory.holds(address, DeviceMemory::page_bytes));
  CHECK_FALSE(memory.holds(address, DeviceMemory::page_bytes + 1));
  CHECK_FALSE(memory.holds(address - 1, 1));
  CHECK_FALSE(memory.holds(0, 1));
  CHECK_FALSE(memory.holds(~uint64_t{0}, 2));
}

TEST_CASE("huge buffers cost nothing until touched; impossible ones are refused by name") {
  Device device;
  const Buffer large = device.create_buffer(uint64_t{1} << 33);
  large.as<std::byte>().back() = std::byte{1};
  CHECK_THROWS_WITH(device.create_buffer(uint64_t{1} << 40), Catch::Matchers::Contains("device memory"));
  CHECK_THROWS_AS(device.create_buffer(~uint64_t{0}), InputError);
}

TEST_CASE("a buffer refuses transfers beyond its end") {
  Device device;
  const Buffer buffer = device.upload(std::vector<uint32_t>{1, 2, 3});
  CHECK(buffer.download<uint32_t>(2, 4) == std::vector<uint32_t>{2, 3});
  CHECK_THROWS_AS(buffer.download<uint32_t>(3, 4), InputError);
  CHECK_THROWS_AS(buffer.upload(std::span<const std::byte>(), 13), InputError);
}

TEST_CASE("a moved buffer frees its memory once") {
  Device device;
  Buffer a = device.create_buffer(1);
  const uint64_t address = a.address();
  {
    Buffer b = std::move(a);
    CHECK(b.address() == address);
    CHECK_FALSE(a);
  }
  CHECK(device.create_buffer(1).address() == address);
}
