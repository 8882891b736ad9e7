#pragma once

// Tags of a set-associative cache with least-recently-used replacement, 128-byte lines (say) of 32-byte sectors. Holds
// no data: only what is present, and what is dirty.

#include <cstdint>
#include <optional>
#include <vector>

namespace rayloom::hwmodel {

using SectorMask = uint32_t;  ///< bit i: sector i of the line

class SectorCache {
 public:
  struct Evicted {
    uint64_t line;
    SectorMask dirty;
  };

  SectorCache(uint32_t sets, uint32_t ways);

  /// Sectors of `line` that are present, and marks the line most recently used. `line`: address / line bytes.
  SectorMask lookup(uint64_t line);
  /// Adds sectors; the line that had to go, if it held dirty sectors.
  std::optional<Evicted> fill(uint64_t line, SectorMask sectors, bool dirty);

 private:
  struct Way {
    uint64_t line = 0;
    uint64_t last_use = 0;
    SectorMask valid = 0, dirty = 0;
  };
  Way* find(uint64_t line);
  Way& victim(uint64_t line);

  std::vector<Way> ways_;
  uint32_t sets_, ways_per_set_;
  uint64_t clock_ = 0;
};

}  // namespace rayloom::hwmodel
