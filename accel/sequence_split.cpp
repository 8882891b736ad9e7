#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/box_area.h>
#include <rayloom/accel/sequence_split.h>

#include <array>

namespace rayloom::accel {

size_t cheapest_cut(std::span<const PrimitiveRef> refs, const Box& box, uint32_t leaf_size, uint64_t block_budget) {
  const BoxArea area(box);
  std::array<float, max_sweep> right_area;
  Box4 part;
  for (size_t i = refs.size(); i-- > 1;) {
    part.extend(box4(refs[i]));
    right_area[i] = area(part);
  }
  part = {};
  size_t best = 0;
  float best_cost = 0;
  for (size_t i = 1; i < refs.size(); ++i) {
    part.extend(box4(refs[i - 1]));
    const uint64_t left_blocks = blocks_for(i, leaf_size), right_blocks = blocks_for(refs.size() - i, leaf_size);
    if (left_blocks + right_blocks > block_budget) continue;
    const float cost = area(part) * static_cast<float>(left_blocks) + right_area[i] * static_cast<float>(right_blocks);
    if (best != 0 && best_cost <= cost) continue;
    best = i;
    best_cost = cost;
  }
  return best;
}

}  // namespace rayloom::accel
