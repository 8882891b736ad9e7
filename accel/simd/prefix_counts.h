#pragma once

#include <array>
#include <cstdint>

namespace rayloom::accel {

/// For each mask of eight lanes, in byte i how many of its lanes come before lane i.
inline constexpr std::array<uint64_t, 256> prefix_counts = [] {
  std::array<uint64_t, 256> counts{};
  for (uint32_t mask = 0; mask < 256; ++mask)
    for (uint64_t lane = 0, before = 0; lane < 8; before += mask >> lane++ & 1) counts[mask] |= before << 8 * lane;
  return counts;
}();

}  // namespace rayloom::accel
