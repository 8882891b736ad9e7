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

}  // namespace rayloom::accel
