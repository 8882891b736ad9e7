#pragma once

// The simulated GPU's memory: one reserved range of host memory whose addresses as seen by programs and the hardware
// model do not depend on where the host put it. Allocations are committed in 64 KiB pages, lie behind one another in
// first-fit order and are parted by an uncommitted guard page. Pages nobody touched cost nothing.

#include <rayloom/accel/build.h>
#include <rayloom/runtime/shader_memory.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

namespace rayloom {

class DeviceMemory {
 public:
  static constexpr uint64_t first_address = 0x1'0000'0000;
  static constexpr uint64_t page_bytes = uint64_t{1} << detail::commit_granularity_log2;
  static constexpr uint64_t default_bytes = uint64_t{64} << 30;
  static constexpr uint64_t least_bytes = uint64_t{1} << 30;

  /// Reserves `bytes`, or halves of it down to 1 GiB where the host allows no more; InputError when not even that.
  explicit DeviceMemory(uint64_t bytes = default_bytes);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  /// Address of `bytes` zeroed bytes, a multiple of 64 KiB; 0 bytes take one page. InputError when memory is exhausted.
  uint64_t allocate(uint64_t bytes);
  /// `address` is one allocate() gave.
  void free(uint64_t address);

  uint64_t reserved_bytes() const { return bytes_; }
  accel::AddressSpace addresses() const;
  /// True when [address, address + bytes) is committed.
  bool holds(uint64_t address, uint64_t bytes) const;
  /// Host memory at an address that holds() accepted.
  std::byte* host(uint64_t address) const { return mapping_ + (address - first_address); }
  detail::ShaderMemory shader_memory() const;

 private:
  uint64_t find_gap(uint64_t bytes) const;

  std::byte* mapping_ = nullptr;
  uint64_t bytes_ = 0;
  uint8_t* committed_ = nullptr;              ///< a flag a page, one page more than there are
  std::map<uint64_t, uint64_t> allocations_;  ///< offset -> committed bytes
  mutable std::mutex mutex_;
};

}  // namespace rayloom
