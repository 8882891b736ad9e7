#pragma once

#include <rayloom/accel/morton.h>

namespace rayloom::accel {

/// Sorts by code, in parallel; keys of one code keep their order.
void radix_sort(std::span<MortonKey> keys);

}  // namespace rayloom::accel
