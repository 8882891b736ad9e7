#include <rayloom/accel/box_area.h>
#include <rayloom/accel/sequence_split.h>

#include <array>
#include <bit>

namespace rayloom::accel {
namespace {

/// Boxes by position, not set to anything at first.
struct Boxes {
  Float4 min[max_sweep], max[max_sweep];

  void set(uint32_t i, const Box4& box) { min[i] = box.min, max[i] = box.max; }
  Box4 operator[](uint32_t i) const { return {min[i], max[i]}; }
};

}  // namespace

/// Into two leaves, as most often, there are fewer positions than references.
SequenceCut cheapest_cut(std::span<const PrimitiveRef> refs, uint32_t leaf_size) {
  const auto count = static_cast<uint32_t>(refs.size());
  const int shift = std::countr_zero(leaf_size);
  const auto blocks = [&](uint32_t primitives) { return (primitives + leaf_size - 1) >> shift; };
  const bool two_leaves = count <= 2 * leaf_size;
  const uint32_t first = two_leaves ? count - leaf_size : 1, last = two_leaves ? leaf_size : count - 1;
  Boxes left, right;  // of the references before a position, and from it on
  Box4 part, whole;
  for (uint32_t i = 1; i <= last; ++i) {
    whole.extend(box4(refs[i - 1]));
    left.set(i, whole);
  }
  for (uint32_t i = count - 1; i > last; --i) part.extend(box4(refs[i]));
  whole.extend(part);
  whole.extend(box4(refs[last]));
  const BoxArea area(whole.box());
  uint32_t best = last;
  float best_cost = Box::infinity;
  for (uint32_t i = last; i >= first; --i) {
    part.extend(box4(refs[i]));
    right.set(i, part);
    const uint32_t left_blocks = blocks(i), right_blocks = blocks(count - i);
    if (left_blocks + right_blocks > blocks(count)) continue;
    const float cost = area(left[i]) * static_cast<float>(left_blocks) + area(part) * static_cast<float>(right_blocks);
    best = cost <= best_cost ? i : best;
    best_cost = std::min(cost, best_cost);
  }
  return {best, left[best], right[best]};
}

}  // namespace rayloom::accel
