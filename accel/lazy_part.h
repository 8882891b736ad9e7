#pragma once

// Parts of lazy structures on their way from triangles to trees.

#include <rayloom/accel/lazy_layout.h>
#include <rayloom/accel/structure.h>

#include <atomic>

namespace rayloom::accel {

namespace detail {
uint32_t build_lazy_part(std::byte* block, uint32_t part);
}

inline std::atomic_ref<uint32_t> root_of_part(const std::byte* block, uint32_t part) {
  return std::atomic_ref(reinterpret_cast<uint32_t*>(const_cast<std::byte*>(block) + LazyLayout::roots)[part]);
}

/// Where rays go on that come to `ref`: if it is a part that is built, at its root.
inline uint32_t past_built_part(const std::byte* block, uint32_t ref) {
  const StructureHeader& header = header_of(block);
  const uint32_t part = (ref & ~node_ref::leaf_bit) - header.first_part;
  if (part >= header.part_count) return ref;
  const uint32_t root = root_of_part(block, part).load(std::memory_order_acquire);
  return root > part_being_built ? root : ref;
}

/// Where rays enter the part of `block` that lies at `stub`. Builds it if need be; a thread that comes while another
/// builds it waits. Throws std::bad_alloc, with a text of its own, when scratch memory cannot be had; the part may be
/// asked for again.
inline uint32_t lazy_part_root(const std::byte* block, const void* stub) {
  const auto granule = static_cast<uint32_t>((static_cast<const std::byte*>(stub) - block) / granule_bytes);
  const uint32_t part = granule - header_of(block).first_part;
  const uint32_t root = root_of_part(block, part).load(std::memory_order_acquire);
  return root > part_being_built ? root : detail::build_lazy_part(const_cast<std::byte*>(block), part);
}

/// How many parts of the block are built.
inline uint32_t built_lazy_parts(const std::byte* block) {
  return std::atomic_ref(lazy_state(const_cast<std::byte*>(block)).built_count).load();
}

}  // namespace rayloom::accel
