#pragma once

#include <rayloom/accel/morton.h>

namespace rayloom::accel {

/// What is done with keys as soon as they are sorted, while they are in the cache.
using OnSorted = std::function<void(std::span<MortonKey>)>;

/// Sorts by code, in parallel; keys of one code keep their order. Upper bits first: keys are spread over memory once,
/// and each bucket is then sorted in the cache. Calls on_sorted, from several threads, for ranges that together are
/// all keys; those of one code are in one range.
void radix_sort(ScratchVector<MortonKey>& keys, const OnSorted& on_sorted);

}  // namespace rayloom::accel
