#pragma once

#include <rayloom/accel/layout.h>

#include <cassert>

namespace rayloom::accel {

/// Nodes and leaves still to visit, the next one on top. No tree is deep enough to overflow it (max_depth). References
/// and distances lie apart, so that a vector of each can be stored above the top and made part of the stack by grow().
class TraversalStack {
 public:
  struct Entry {
    uint32_t ref;
    float near;  ///< where the ray enters the box
  };
  static constexpr uint32_t lanes = 8;  ///< what may be stored above the top at once

  bool empty() const { return size_ == 0; }
  uint32_t size() const { return size_; }
  Entry pop() {
    --size_;
    return {refs_[size_], nears_[size_]};
  }
  uint32_t pop_ref() { return refs_[--size_]; }
  void restore_popped() { ++size_; }
  void push(uint32_t ref, float near) {
    assert(size_ < stack_entries);
    refs_[size_] = ref;
    nears_[size_++] = near;
  }

  uint32_t* free_refs() { return refs_ + size_; }
  float* free_nears() { return nears_ + size_; }
  void grow(uint32_t count) {
    size_ += count;
    assert(size_ <= stack_entries);
  }

  uint32_t* refs() { return refs_; }
  float* nears() { return nears_; }
  void resize(uint32_t size) { size_ = size; }

 private:
  uint32_t size_ = 0;
  uint32_t refs_[stack_entries + lanes];
  float nears_[stack_entries + lanes];
};

}  // namespace rayloom::accel
