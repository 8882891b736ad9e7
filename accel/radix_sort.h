#pragma once

#include <rayloom/accel/morton.h>

namespace rayloom::accel {

/// Sorts by code, in parallel; keys of one code keep their order. Upper bits first: keys are spread over memory once,
/// and each bucket is then sorted in the cache.
void radix_sort(std::span<MortonKey> keys);

}  // namespace rayloom::accel
