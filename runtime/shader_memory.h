#pragma once

// How shaders reach device memory. Views hold simulated addresses only; while a thread runs shaders, one thread-local
// ShaderMemory translates them, so an address that is not committed memory reads as zeros and swallows stores instead
// of crashing (ERR-06). When a tracer observes shaders every access is told to it; otherwise that costs one untaken
// branch.

#include <rayloom/runtime/tracer.h>

#include <cstring>
#include <new>
#include <type_traits>

namespace rayloom {

class Device;

namespace detail {

/// The lane whose shader is running, for a tracer that observes shaders.
struct LaneObserver {
  WarpTracer* tracer;
  uint32_t lane;
};

inline constexpr uint32_t commit_granularity_log2 = 16;

struct ShaderMemory {
  uintptr_t base = 0;                  ///< host address = base + simulated address
  uint64_t first = 0;                  ///< lowest simulated address
  uint64_t bytes = 0;                  ///< 0 outside of a dispatch: nothing is reachable
  const uint8_t* committed = nullptr;  ///< one flag a 64 KiB page
  const LaneObserver* observer = nullptr;

  /// Host pointer to `size` (1..64 KiB) committed bytes at `address`, else null.
  std::byte* host(uint64_t address, uint64_t size) const {
    const uint64_t offset = address - first;
    if (offset >= bytes || !committed[offset >> commit_granularity_log2] ||
        !committed[(offset + size - 1) >> commit_granularity_log2])
      return nullptr;
    return reinterpret_cast<std::byte*>(base + address);
  }
  /// Whether [address, address + size) is committed; any size.
  bool committed_all(uint64_t address, uint64_t size) const {
    const uint64_t offset = address - first;
    if (offset >= bytes || size > bytes - offset) return false;
    for (uint64_t page = offset >> commit_granularity_log2; page << commit_granularity_log2 < offset + size; ++page)
      if (!committed[page]) return false;
    return true;
  }
};

inline thread_local constinit ShaderMemory shader_memory{};

[[gnu::cold, gnu::noinline]] inline void tell_access(const LaneObserver& observer, AccessKind kind, uint64_t address,
                                                     uint32_t bytes, const void* data) {
  observer.tracer->access(observer.lane, kind, address, bytes, data);
}

/// Where it can, as an object: a value that a shader has just put together then goes from registers, not by way of
/// the stack, where the processor would wait for its parts to arrive.
template <class T>
[[gnu::always_inline]] inline void put(std::byte* host, const T& value) {
  if (reinterpret_cast<uintptr_t>(host) % alignof(T) == 0) [[likely]] {
    ::new (static_cast<void*>(host)) T(value);
  } else {
    const T copy = value;
    std::memcpy(host, static_cast<const void*>(&copy), sizeof(T));
  }
}

template <class T>
[[gnu::always_inline]] inline T load(uint64_t address) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 65536);
  T value{};
  const ShaderMemory& memory = shader_memory;
  if (const std::byte* host = memory.host(address, sizeof(T))) [[likely]] {
    if (memory.observer) [[unlikely]]
      tell_access(*memory.observer, AccessKind::load, address, sizeof(T), nullptr);
    std::memcpy(static_cast<void*>(&value), host, sizeof(T));
  }
  return value;
}

template <class T>
[[gnu::always_inline]] inline void store(uint64_t address, const T& value) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 65536);
  const ShaderMemory& memory = shader_memory;
  if (std::byte* host = memory.host(address, sizeof(T))) [[likely]] {
    if (memory.observer) [[unlikely]] {
      const T copy = value;
      tell_access(*memory.observer, AccessKind::store, address, sizeof(T), &copy);
    }
    put(host, value);
  }
}

/// What operator[] of a writable view gives: reads load, assignments store.
template <class T>
class ElementReference {
 public:
  explicit ElementReference(uint64_t address) : address_(address) {}
  ElementReference(const ElementReference&) = default;

  operator T() const { return address_ ? load<T>(address_) : T{}; }
  const ElementReference& operator=(const T& value) const {
    if (address_) store(address_, value);
    return *this;
  }
  const ElementReference& operator=(const ElementReference& other) const { return *this = static_cast<T>(other); }
  const ElementReference& operator+=(const T& value) const { return *this = static_cast<T>(*this) + value; }
  const ElementReference& operator-=(const T& value) const { return *this = static_cast<T>(*this) - value; }
  const ElementReference& operator*=(const T& value) const { return *this = static_cast<T>(*this) * value; }
  uint64_t address() const { return address_; }

 private:
  uint64_t address_;  // 0: out of range, loads give zeros and stores are dropped
};

}  // namespace detail

/// Makes views usable on this thread outside of a dispatch, for tests and host-side helpers.
class ShaderMemoryScope {
 public:
  explicit ShaderMemoryScope(const Device& device);
  ~ShaderMemoryScope() { detail::shader_memory = outer_; }
  ShaderMemoryScope(const ShaderMemoryScope&) = delete;
  ShaderMemoryScope& operator=(const ShaderMemoryScope&) = delete;

 private:
  detail::ShaderMemory outer_;
};

}  // namespace rayloom
