#pragma once

#include <rayloom/accel/layout.h>

#include <cstddef>

namespace rayloom::accel {

/// The header of a block known to be a structure.
inline const StructureHeader& header_of(const std::byte* block) {
  return *reinterpret_cast<const StructureHeader*>(block);
}

/// Whether some of the structure, or of what its instances refer to, may not be built yet.
inline bool is_lazy(const StructureHeader& header) { return header.lazy_root != 0; }

/// Where rays start, whether it is lazy or not; no_index for a structure without active primitives.
inline uint32_t root_of(const StructureHeader& header) { return is_lazy(header) ? header.lazy_root : header.root; }

/// The header of `block`; throws InputError, naming `object`, when it is not a structure this version wrote.
const StructureHeader& checked_header(const std::byte* block, const char* object);

}  // namespace rayloom::accel
