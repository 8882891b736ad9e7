#pragma once

#include <rayloom/accel/layout.h>

#include <cstddef>

namespace rayloom::accel {

/// The header of a block known to be a structure.
inline const StructureHeader& header_of(const std::byte* block) {
  return *reinterpret_cast<const StructureHeader*>(block);
}

/// The header of `block`; throws InputError, naming `object`, when it is not a structure this version wrote.
const StructureHeader& checked_header(const std::byte* block, const char* object);

}  // namespace rayloom::accel
