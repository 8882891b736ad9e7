#pragma once

#include <rayloom/accel/layout.h>

#include <bit>
#include <cstdint>
#include <vector>

namespace rayloom::hwmodel {

/// A ray's stack of nodes and leaves still to visit. The hardware's own, not accel's: the replay's order is checked
/// against the capture, and later forms of it (short stack, restart trail) replace this class.
class RayStack {
 public:
  struct Entry {
    uint32_t ref;
    float near;  ///< where the ray enters the box
  };

  bool empty() const { return entries_.empty(); }
  size_t size() const { return entries_.size(); }
  void clear() { entries_.clear(); }
  void push(uint32_t ref, float near) { entries_.push_back({ref, near}); }
  Entry pop() {
    const Entry top = entries_.back();
    entries_.pop_back();
    return top;
  }

  /// Children of `mask`: the nearest on top, the lowest lane before its equals; or the highest lane on top.
  void push_children(const accel::Node8& node, uint32_t mask, const float (&near)[8], bool sorted) {
    const size_t first = entries_.size();
    for (uint32_t left = mask; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      size_t place = entries_.size();
      if (sorted)
        while (place > first && entries_[place - 1].near <= near[lane]) --place;
      entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(place), {node.child[lane], near[lane]});
    }
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace rayloom::hwmodel
