#pragma once

// Reads a structure's nodes as traversal does.

#include <cstddef>
#include <cstdint>

namespace rayloom::bench::numerics {

struct EnclosureCount {
  uint64_t children = 0;
  uint64_t not_enclosed = 0;  ///< children whose content sticks out of the box their node stores
  double excess_area = 0;     ///< stored area over needed area, less 1, in the mean over the children
};

/// Compares every stored box with the exact box of what lies below it. For structures over procedural boxes.
EnclosureCount check_enclosure(const std::byte* block);

}  // namespace rayloom::bench::numerics
