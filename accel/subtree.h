#pragma once

// How top-down builders share out slots, leaves and threads.

#include <rayloom/accel/binned_sah.h>
#include <rayloom/base/parallel.h>

#include <utility>

namespace rayloom::accel {

/// From this depth on builders halve: 2^29 primitives down to one leaf take at most 29 further levels, so no tree is
/// deeper than max_depth.
inline constexpr uint32_t max_choice_depth = 32;

/// A subtree to build: it owns the slots [slot, slot + 2 * budget - 1) and the primitives [first, first + count).
struct Subtree {
  uint32_t slot, first, count, budget, depth;
};

/// The parts of a subtree split after `left_count` primitives. Blocks that the budget has beyond need are shared out in
/// proportion to need.
inline std::pair<Subtree, Subtree> halves_of(const Subtree& parent, uint32_t left_count, uint32_t leaf_size) {
  const uint32_t right_count = parent.count - left_count;
  const uint64_t left_need = blocks_for(left_count, leaf_size), right_need = blocks_for(right_count, leaf_size);
  const uint64_t slack = parent.budget - left_need - right_need;
  const uint64_t extra = left_need == right_need ? slack / 2 : slack * left_need / (left_need + right_need);
  const auto left_budget = static_cast<uint32_t>(left_need + extra);
  const uint32_t depth = parent.depth + 1;
  return {{parent.slot + 1, parent.first, left_count, left_budget, depth},
          {parent.slot + 2 * left_budget, parent.first + left_count, right_count, parent.budget - left_budget, depth}};
}

/// Calls build(left) and build(right), at the same time where they have `large` primitives together.
template <class Build>
void build_halves(const Subtree& left, const Subtree& right, const Build& build, uint32_t large = 4096) {
  if (left.count + right.count >= large)
    return parallel_invoke([&build, left] { build(left); }, [&build, right] { build(right); });
  build(left);
  build(right);
}

}  // namespace rayloom::accel
