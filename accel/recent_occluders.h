#pragma once

#include <rayloom/accel/traversal_stack.h>

#include <algorithm>
#include <cstdint>

namespace rayloom::accel {

/// What occluded the last rays of a batch, as references of their top level: whatever occludes a ray often occludes its
/// neighbours. Rays that only ask whether they hit anything try it first, as long as most rays find their answer there:
/// for such rays the order of visits does not show.
class RecentOccluders {
 public:
  bool empty() const { return count_ == 0; }

  /// Puts them on the stack, the last one on top.
  void push(TraversalStack& stack) {
    std::copy_n(refs_, most, stack.free_refs());
    stack.grow(count_);
    if (++tried_ % window != 0) return;
    given_up_ = missed_ > most_missed;
    missed_ = 0;
  }

  /// Whether too many rays had to look further.
  bool given_up() const { return given_up_; }

  void note_missed() { ++missed_; }

  void note_occluder(uint32_t ref) {
    uint32_t* const end = refs_ + count_;
    uint32_t* const found = std::find(refs_, end, ref);
    if (found != end) return void(std::rotate(found, found + 1, end));
    if (count_ == most) std::copy(refs_ + 1, end, refs_);
    count_ = std::min(count_ + 1, most);
    refs_[count_ - 1] = ref;
  }

 private:
  /// In a forest, where four in five is about break-even: nineteen in twenty shadow rays, three in five short ones.
  static constexpr uint32_t most = 8, window = 128, most_missed = window / 4;

  uint32_t refs_[most] = {};
  uint32_t count_ = 0, tried_ = 0, missed_ = 0;
  bool given_up_ = false;
};

}  // namespace rayloom::accel
