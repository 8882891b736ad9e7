#pragma once

#include <array>
#include <cstdint>

namespace rayloom::accel {

/// For each mask of eight lanes, its lanes in order, then lane 0. AVX2 has no instruction that moves lanes together.
/// (Highway 1.0's Compress for AVX2 keeps its table in a local variable, which GCC 12 copies at every use.)
struct CompressTable {
  alignas(64) std::array<std::array<uint8_t, 8>, 256> lanes{};
  constexpr CompressTable() {
    for (uint32_t mask = 0; mask < 256; ++mask)
      for (uint8_t lane = 0, place = 0; lane < 8; ++lane)
        if (mask >> lane & 1) lanes[mask][place++] = lane;
  }
};

inline constexpr CompressTable compress_table;

}  // namespace rayloom::accel
