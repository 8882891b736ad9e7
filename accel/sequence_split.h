#pragma once

#include <rayloom/accel/float4.h>

#include <cstddef>
#include <span>

namespace rayloom::accel {

/// Longest sequence the sweep below takes.
inline constexpr size_t max_sweep = 16;

struct SequenceCut {
  size_t left_count;
  Box4 left, right;  ///< boxes of the parts
};

/// Where to cut a sequence of references whose order stays: the first position of least surface area cost, counted in
/// leaf blocks, among those that take no more blocks than the whole.
/// leaf_size < refs.size() <= max_sweep; leaf_size is a power of two.
SequenceCut cheapest_cut(std::span<const PrimitiveRef> refs, uint32_t leaf_size);

}  // namespace rayloom::accel
