#pragma once

#include <rayloom/accel/layout.h>

#include <bit>
#include <cassert>

namespace rayloom::accel {

/// What a push tells nobody.
struct NoHint {
  void operator()(uint32_t /*ref*/) const {}
};

/// Nodes and leaves still to visit, the next one on top. No tree is deep enough to overflow it (max_depth).
class TraversalStack {
 public:
  struct Entry {
    uint32_t ref;
    float near;  ///< where the ray enters the box
  };

  bool empty() const { return size_ == 0; }
  Entry pop() { return entries_[--size_]; }
  void push(uint32_t ref, float near) {
    assert(size_ < stack_entries);
    entries_[size_++] = {ref, near};
  }

  /// Children of `mask`, the lowest lane on top. `hint` hears of each reference as it is pushed.
  template <class Hint = NoHint>
  void push_in_order(const Node8& node, uint32_t mask, const float (&near)[8], Hint hint = {}) {
    for (; mask != 0; mask &= ~(1u << top_lane(mask))) {
      const int lane = top_lane(mask);
      hint(node.child[lane]);
      push(node.child[lane], near[lane]);
    }
  }

  /// Children of `mask`, the nearest on top and the lowest lane before its equals.
  template <class Hint = NoHint>
  void push_sorted(const Node8& node, uint32_t mask, const float (&near)[8], Hint hint = {}) {
    assert(size_ + static_cast<uint32_t>(std::popcount(mask)) <= stack_entries);
    const uint32_t first = size_;
    for (; mask != 0; mask &= ~(1u << top_lane(mask))) {
      const int lane = top_lane(mask);
      hint(node.child[lane]);
      uint32_t place = size_++;
      for (; place > first && entries_[place - 1].near < near[lane]; --place) entries_[place] = entries_[place - 1];
      entries_[place] = {node.child[lane], near[lane]};
    }
  }

 private:
  static int top_lane(uint32_t mask) { return 31 - std::countl_zero(mask); }

  uint32_t size_ = 0;
  Entry entries_[stack_entries];
};

}  // namespace rayloom::accel
