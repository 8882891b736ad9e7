#pragma once

// Replaces the program's operator new by one that can be told to fail. For one source file of a test program.

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

namespace rayloom::accel::test {

inline constexpr int64_t unlimited = std::numeric_limits<int64_t>::max();

/// How many allocations succeed before some fail, and how many fail then.
inline std::atomic<int64_t> allocations_left = unlimited, failures_wanted = unlimited;

/// Lets so many allocations of the program succeed and those after them fail, all or as many as said, while it lives.
class AllocationLimit {
 public:
  explicit AllocationLimit(int64_t allocations, int64_t failures = unlimited) {
    failures_wanted = failures;
    allocations_left = allocations;
  }
  ~AllocationLimit() { allocations_left = unlimited; }
  AllocationLimit(const AllocationLimit&) = delete;
  AllocationLimit& operator=(const AllocationLimit&) = delete;

  bool reached() const { return allocations_left < 0; }
};

inline void* allocated_or_failed(void* (*allocate)(size_t, size_t), size_t bytes, size_t alignment) {
  if (allocations_left.load(std::memory_order_relaxed) != unlimited) {
    const int64_t left = allocations_left.fetch_sub(1);
    if (left <= 0 && -left < failures_wanted) throw std::bad_alloc();
  }
  if (void* const memory = allocate(bytes, alignment)) return memory;
  throw std::bad_alloc();
}

}  // namespace rayloom::accel::test

[[gnu::noinline]] void* operator new(size_t bytes) {
  const auto plain = [](size_t size, size_t) { return std::malloc(size); };
  return rayloom::accel::test::allocated_or_failed(plain, bytes, 0);
}
[[gnu::noinline]] void* operator new(size_t bytes, std::align_val_t alignment) {
  const auto aligned = [](size_t size, size_t at) { return std::aligned_alloc(at, (size + at - 1) / at * at); };
  return rayloom::accel::test::allocated_or_failed(aligned, bytes, static_cast<size_t>(alignment));
}
[[gnu::noinline]] void* operator new(size_t bytes, const std::nothrow_t&) noexcept { return std::malloc(bytes); }
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
