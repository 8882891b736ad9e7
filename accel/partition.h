#pragma once

#include <rayloom/accel/binned_sah.h>

namespace rayloom::accel {

/// Moves the primitives that go left to the front and returns their number. `scratch` is as long as `refs`.
size_t partition_by_split(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, const Split& split);

/// Halves `refs` along the longest axis of their centres, the left part a multiple of `leaf_size`; equal centres go by
/// name. Always possible, always within the block budget of the whole. refs.size() > leaf_size.
size_t partition_by_median(std::span<PrimitiveRef> refs, const Box& centres, uint32_t leaf_size);

}  // namespace rayloom::accel
