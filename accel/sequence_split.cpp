#include <rayloom/accel/box_area.h>
#include <rayloom/accel/sequence_split.h>

#include <array>
#include <bit>

namespace rayloom::accel {

SequenceCut cheapest_cut(std::span<const PrimitiveRef> refs, uint32_t leaf_size) {
  const auto count = static_cast<uint32_t>(refs.size());
  const int shift = std::countr_zero(leaf_size);
  const auto blocks = [&](uint32_t primitives) { return (primitives + leaf_size - 1) >> shift; };
  std::array<Box4, max_sweep + 1> left, right;  // of the references before a position, and from it on
  Box4 part;
  for (uint32_t i = 1; i <= count; ++i) {
    part.extend(box4(refs[i - 1]));
    left[i] = part;
  }
  const BoxArea area(part.box());
  part = {};
  uint32_t best = 0;
  float best_cost = Box::infinity;
  for (uint32_t i = count; i-- > 1;) {
    part.extend(box4(refs[i]));
    right[i] = part;
    const uint32_t left_blocks = blocks(i), right_blocks = blocks(count - i);
    if (left_blocks + right_blocks > blocks(count)) continue;
    const float cost = area(left[i]) * static_cast<float>(left_blocks) + area(part) * static_cast<float>(right_blocks);
    best = cost <= best_cost ? i : best;
    best_cost = std::min(cost, best_cost);
  }
  return {best, left[best], right[best]};
}

}  // namespace rayloom::accel
