#pragma once

#include <rayloom/accel/primitive_ref.h>

#include <cstddef>
#include <span>

namespace rayloom::accel {

/// Longest sequence the sweep below takes.
inline constexpr size_t max_sweep = 64;

/// Where to cut a sequence of references whose order stays: the first position of least surface area cost, counted in
/// leaf blocks, whose parts fit `block_budget` blocks together. Always finds one when the whole fits.
/// leaf_size < refs.size() <= max_sweep.
size_t cheapest_cut(std::span<const PrimitiveRef> refs, const Box& box, uint32_t leaf_size, uint64_t block_budget);

}  // namespace rayloom::accel
