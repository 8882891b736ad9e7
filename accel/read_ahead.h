#pragma once

#include <cstddef>
#include <cstdint>

namespace rayloom::accel {

/// For loops that read an array from front to back, once a line or more often: asks for the line that is read so much
/// later. Machines' own prefetching stops at each page, and in virtual machines may do little.
[[gnu::always_inline]] inline void read_ahead(const void* now) {
  constexpr uintptr_t distance = 2048;
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<uintptr_t>(now) + distance));
}

/// The same for an array that is written, some 200 bytes at a time.
[[gnu::always_inline]] inline void write_ahead(const void* now) {
  constexpr uintptr_t distance = 1024, line = 64;
  for (uintptr_t i = 0; i < 4; ++i)
    __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<uintptr_t>(now) + distance + line * i), 1);
}

}  // namespace rayloom::accel
