#pragma once

// How the children that a ray meets go on the stack, in plain C++: the oracle of children-inl.h.

#include <rayloom/accel/simd/lanes_scalar.h>
#include <rayloom/accel/traversal_stack.h>

namespace rayloom::accel::scalar {

/// Any-hit rays visit children from the highest lane down: Collapse has put the most promising one last.
inline void push_in_order(const NodeHits& hits, const Node8& node, TraversalStack& stack) {
  for (uint32_t left = hits.mask; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    stack.push(node.child[lane], hits.near[lane]);
  }
}

/// Closest-hit rays visit the nearest child first, equals from the lowest lane up.
inline void push_by_distance(const NodeHits& hits, const Node8& node, TraversalStack& stack) {
  const uint32_t base = stack.size();
  for (int lane = 7; lane >= 0; --lane) {
    if ((hits.mask >> lane & 1) == 0) continue;
    stack.push(node.child[lane], hits.near[lane]);
    for (uint32_t i = stack.size() - 1; i > base && stack.nears()[i - 1] < stack.nears()[i]; --i) {
      std::swap(stack.nears()[i - 1], stack.nears()[i]);
      std::swap(stack.refs()[i - 1], stack.refs()[i]);
    }
  }
}

/// The child that push_by_distance() puts on top.
inline TraversalStack::Entry nearest_child(const NodeHits& hits, const Node8& node) {
  int nearest = std::countr_zero(hits.mask);
  for (uint32_t left = hits.mask & (hits.mask - 1); left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    if (hits.near[lane] < hits.near[nearest]) nearest = lane;
  }
  return {node.child[nearest], hits.near[nearest]};
}

/// Takes away entries from `base` up that lie beyond t_far.
inline void drop_farther(TraversalStack& stack, uint32_t base, float t_far) {
  uint32_t kept = base;
  for (uint32_t i = base; i < stack.size(); ++i) {
    if (stack.nears()[i] > t_far) continue;
    stack.refs()[kept] = stack.refs()[i];
    stack.nears()[kept++] = stack.nears()[i];
  }
  stack.resize(kept);
}

}  // namespace rayloom::accel::scalar
