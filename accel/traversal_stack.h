#pragma once

#include <rayloom/accel/layout.h>

#include <cassert>

namespace rayloom::accel {

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

  /// Writes entry `i` above the top, which grow() makes part of the stack.
  void place(uint32_t i, Entry entry) {
    assert(size_ + i < stack_entries);
    entries_[size_ + i] = entry;
  }
  void grow(uint32_t count) { size_ += count; }

 private:
  uint32_t size_ = 0;
  Entry entries_[stack_entries];
};

}  // namespace rayloom::accel
