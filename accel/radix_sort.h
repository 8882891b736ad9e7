#pragma once

#include <rayloom/accel/morton.h>

namespace rayloom::accel {

/// Sorts by bits [low_bit, high_bit) of the codes, in parallel; keys equal there keep their order.
void radix_sort(std::span<MortonKey> keys, int low_bit, int high_bit);

}  // namespace rayloom::accel
