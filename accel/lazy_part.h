#pragma once

// Parts of lazy structures on their way from triangles to trees.

#include <rayloom/accel/lazy_layout.h>

#include <atomic>

namespace rayloom::accel {

namespace detail {
uint32_t build_lazy_part(std::byte* block, LazyPart& part);
}

/// Where rays enter the part of `block` that begins at `stub`. Builds it if need be; a thread that comes while another
/// builds it waits. Throws std::bad_alloc, with a text that names the part, when scratch memory cannot be had; the part
/// may be asked for again.
inline uint32_t lazy_part_root(const std::byte* block, const void* stub) {
  auto& part = *static_cast<LazyPart*>(const_cast<void*>(stub));
  const uint32_t root = std::atomic_ref(part.root).load(std::memory_order_acquire);
  if (root > LazyPart::being_built) [[likely]]
    return root;
  return detail::build_lazy_part(const_cast<std::byte*>(block), part);
}

/// How many parts of the block are built.
inline uint32_t built_lazy_parts(const std::byte* block) {
  return std::atomic_ref(lazy_state(const_cast<std::byte*>(block)).built_count).load();
}

}  // namespace rayloom::accel
