#pragma once

// The memory a replay writes: what the captured shaders stored, in the order of simulated time. Nothing else is in it.

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace rayloom::hwmodel {

class ShadowMemory {
 public:
  void store(uint64_t address, std::span<const std::byte> data);

  /// Copies [address, address + out.size()) to `out`; bytes never stored keep the value `out` had.
  void read(uint64_t address, std::span<std::byte> out) const;
  /// How many bytes of the range were stored.
  uint64_t bytes_stored(uint64_t address, uint64_t bytes) const;

 private:
  static constexpr uint64_t page_bytes = 4096;
  struct Page {
    std::vector<std::byte> data = std::vector<std::byte>(page_bytes);
    std::vector<bool> stored = std::vector<bool>(page_bytes);
  };
  template <class Function>
  void for_each_stored(uint64_t address, uint64_t bytes, Function&& function) const;

  std::map<uint64_t, Page> pages_;
};

}  // namespace rayloom::hwmodel
