// Several packets at a time: while the bytes that one needs next are on their way, the others take their steps. Only
// for targets with vectors; re-included once per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKETS_IN_TURN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKETS_IN_TURN_INL_H
#undef RAYLOOM_ACCEL_PACKETS_IN_TURN_INL_H
#else
#define RAYLOOM_ACCEL_PACKETS_IN_TURN_INL_H
#endif
// clang-format on

#include <rayloom/accel/kept_array.h>
#include <rayloom/accel/simd/packet_vectors-inl.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// Traces what goes together of a run of rays. A Packet has `load(group, wanted)`, which takes on some of the wanted
/// rays of a group of Packet::size, fewer at the end, and returns them, 0 if none go together; `step()`, until it is
/// `done()`; and `write(rays, results)`. Packet::most: how many are worth having under way, if there are groups_each
/// for each of them.
template <class Packet>
class PacketsInTurn {
 public:
  using Result = typename Packet::Result;

  PacketsInTurn(AddressSpace addresses, const RayRun& rays, Result* results)
      : run_(rays), results_(results), slots_(Packet::most) {
    const size_t count = std::clamp(rays.count / (Packet::groups_each * size), size_t{1}, Packet::most);
    for (size_t i = 0; i < count; ++i) slots_.emplace_back(addresses, *rays.shared);
  }

  /// `leave(begin, count)` is told of rays that do not go together, in ascending order.
  template <class Leave>
  void run(const Leave& leave) {
    Slot* active[Packet::most];
    size_t count = 0;
    for (Slot& slot : slots_)
      if (start(slot, leave)) active[count++] = &slot;
    while (count != 0) {
      for (size_t i = 0; i < count; ++i) {
        Slot& slot = *active[i];
        slot.packet.step();
        if (HWY_LIKELY(!slot.packet.done())) continue;
        slot.packet.write(slot.taken, results_ + slot.first);
        if (!start(slot, leave)) active[i--] = active[--count];
      }
    }
  }

 private:
  struct Slot {
    Slot(AddressSpace addresses, const TraceRequest& shared) : packet(addresses, shared) {}
    size_t first = 0;    ///< ray of the run
    uint32_t taken = 0;  ///< rays from there on
    Packet packet;
  };

  /// Gives the packet the next rays that go together; false if there are none. Where rays do not, fewer and fewer
  /// groups are asked.
  template <class Leave>
  bool start(Slot& slot, const Leave& leave) {
    while (group_size() >= fewest) {
      slot.first = next_;
      slot.taken = slot.packet.load(run_.part(next_, group_size()), wanted_);
      wanted_ &= ~slot.taken;
      if (slot.taken == 0) leave_group(leave);
      if (wanted_ == 0) begin_next(group_size());
      if (slot.taken != 0) {
        skipped_ = 0;
        return true;
      }
    }
    if (next_ < run_.count) leave(next_, run_.count - next_);
    next_ = run_.count;
    return false;
  }

  /// What is wanted of the next group, and, if that is all of it, some groups after it.
  template <class Leave>
  void leave_group(const Leave& leave) {
    if (wanted_ != everyone()) {
      for (; wanted_ != 0; wanted_ &= wanted_ - 1) leave(next_ + static_cast<size_t>(std::countr_zero(wanted_)), 1);
      return;
    }
    const size_t count = std::min(run_.count - next_, size * (1 + skipped_));
    leave(next_, count);
    begin_next(count);
    skipped_ = std::min(2 * skipped_ + 1, most_skipped);
  }

  void begin_next(size_t count) {
    next_ += count;
    wanted_ = everyone();
  }

  /// Of the group at next_.
  size_t group_size() const { return std::min(size, run_.count - next_); }
  uint32_t everyone() const { return group_size() == 0 ? 0 : ~0u >> (32 - group_size()); }

  static constexpr size_t size = Packet::size, fewest = packet_size / 2, most_skipped = 15;

  RayRun run_;
  Result* results_;
  size_t next_ = 0;
  uint32_t wanted_ = everyone();  ///< of the group at next_
  size_t skipped_ = 0;            ///< groups left unasked after the last that did not go together
  KeptArray<Slot> slots_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
