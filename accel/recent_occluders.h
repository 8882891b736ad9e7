#pragma once

#include <rayloom/accel/traversal_stack.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace rayloom::accel {

/// What occluded the last rays of a batch, as references of their top level: whatever occludes a ray often occludes its
/// neighbours. Rays that only ask whether they hit anything try it first, as long as most rays find their answer there:
/// for such rays the order of visits does not show.
class RecentOccluders {
 public:
  bool empty() const { return count_ == 0; }

  /// Puts them on the stack, the last one on top, and `first`, unless 0, above them or, if it is among them, in that
  /// one's place, which takes its own. There must be some.
  void push(TraversalStack& stack, uint32_t first) {
    uint32_t* const refs = stack.free_refs();
    std::copy_n(refs_, most, refs);
    uint32_t count = count_;
    if (first != 0 && first != refs_[count_ - 1]) {
      uint32_t same = 0;  // a bit each; all of them, so that the compiler may take a vector
      for (uint32_t i = 0; i < most; ++i) same |= uint32_t{refs_[i] == first} << i;
      refs[count] = first;
      count += same == 0;
      std::swap(refs[same == 0 ? count_ : static_cast<uint32_t>(std::countr_zero(same))], refs[count - 1]);
    }
    stack.grow(count);
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
