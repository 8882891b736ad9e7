#pragma once

// Vectors for a builder's arrays: elements start uninitialised. Large ones come in huge pages where the system has them
// and are kept for the next build, since clearing new pages took a fifth of a fast build's time. So are those from 64
// KB on: threads that ask the system for memory wait for others whose new pages it is clearing.

#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace rayloom::accel {

namespace detail {
void* allocate_scratch(size_t bytes);
void free_scratch(void* memory, size_t bytes);
}  // namespace detail

template <class T>
struct ScratchAllocator {
  using value_type = T;
  static_assert(alignof(T) <= alignof(std::max_align_t));

  ScratchAllocator() = default;
  template <class U>
  ScratchAllocator(const ScratchAllocator<U>&) {}

  T* allocate(size_t count) { return static_cast<T*>(detail::allocate_scratch(count * sizeof(T))); }
  void deallocate(T* memory, size_t count) { detail::free_scratch(memory, count * sizeof(T)); }

  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0)
      ::new (static_cast<void*>(place)) U;  // a plain struct keeps whatever the memory holds
    else
      ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
  template <class U>
  bool operator==(const ScratchAllocator<U>&) const {
    return true;
  }
};

template <class T>
using ScratchVector = std::vector<T, ScratchAllocator<T>>;

}  // namespace rayloom::accel
