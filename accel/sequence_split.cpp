#include <rayloom/accel/box_area.h>
#include <rayloom/accel/sequence_split.h>

#include <array>
#include <bit>

namespace rayloom::accel {

SequenceCut cheapest_cut(std::span<const PrimitiveRef> refs, const Box4& box, uint32_t leaf_size,
                         uint64_t block_budget) {
  const BoxArea area(box.box());
  const auto count = static_cast<uint32_t>(refs.size());
  const int shift = std::countr_zero(leaf_size);
  const auto blocks = [&](uint32_t primitives) { return (primitives + leaf_size - 1) >> shift; };
  std::array<Box4, max_sweep> right;
  std::array<float, max_sweep> right_area;
  Box4 part;
  for (uint32_t i = count; i-- > 1;) {
    part.extend(box4(refs[i]));
    right[i] = part;
    right_area[i] = area(part);
  }
  part = {};
  SequenceCut best{0, {}, {}};
  float best_cost = Box::infinity;
  for (uint32_t i = 1; i < count; ++i) {
    part.extend(box4(refs[i - 1]));
    const uint32_t left_blocks = blocks(i), right_blocks = blocks(count - i);
    if (left_blocks + right_blocks > block_budget) continue;
    const float cost = area(part) * static_cast<float>(left_blocks) + right_area[i] * static_cast<float>(right_blocks);
    if (best_cost <= cost) continue;
    best_cost = cost;
    best.left_count = i;
    best.left = part;
  }
  best.right = right[best.left_count];
  return best;
}

}  // namespace rayloom::accel
