#pragma once

// The top-level structures a dispatch traces: checked once, with a way from an instance's index to its record.

#include <rayloom/accel/layout.h>
#include <rayloom/runtime/device_memory.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::detail {

struct TopLevel {
  const std::byte* block = nullptr;  ///< null: rays miss, for the reason `row` and `problem` give
  std::string_view row;
  std::string problem;
  std::vector<const accel::InstanceRecord*> instances;  ///< by instance index; null for inactive ones
  bool has_procedurals = false;
  bool has_non_opaque = false;  ///< triangles, after the flags of geometry and instance

  /// False when no ray with these flags (accel::ray_flag) meets a candidate: traversal then needs no way to ask.
  bool asks(uint32_t ray_flags) const;
};

/// Thread-safe; lives as long as one dispatch, because structures may be rebuilt between two.
class StructureCache {
 public:
  /// `complete`: lazy structures are completed before they are traced, for tracers that look at their bytes.
  explicit StructureCache(const DeviceMemory& memory, bool complete = false) : memory_(memory), complete_(complete) {}

  /// `address` is not 0. The reference stays valid as long as the cache.
  const TopLevel& find(uint64_t address);

 private:
  TopLevel inspect(uint64_t address) const;

  const DeviceMemory& memory_;
  bool complete_;
  std::map<uint64_t, TopLevel> entries_;
  std::mutex mutex_;
};

}  // namespace rayloom::detail
