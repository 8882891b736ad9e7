#include <rayloom/accel/parts_in_order.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace rayloom::accel {
namespace {

/// All but one may wait for slower parts before theirs.
constexpr size_t thread_slots = 16;
constexpr uint64_t small_page = 4096, huge_page = uint64_t{2} << 20;

/// Has the system clear the pages of a range, whose bytes stay. A hint: failure costs time only.
void populate([[maybe_unused]] std::byte* begin, [[maybe_unused]] uint64_t bytes) {
#if defined(MADV_POPULATE_WRITE)
  const uint64_t in_page = reinterpret_cast<uintptr_t>(begin) % small_page;
  if (bytes > 0) madvise(begin - in_page, bytes + in_page, MADV_POPULATE_WRITE);
#endif
}

}  // namespace

/// A thread's builder and parts: one in the making, others that wait for a place. Most often the first slot is the only
/// one in use, whose memory stays in the core's cache.
class PartsInOrder::Worker {
 public:
  explicit Worker(PartsInOrder& all) : all_(all), builder_(all.order_, all.input_) {}

  /// A part is taken with a slot at hand, so the first part without a place is always being built: waiting comes to
  /// an end.
  void work() {
    while (Slot* const slot = free_slot()) {
      const size_t part = all_.take();
      if (part == all_.parts_.size()) break;
      build(part, *slot);
      move_before(all_.finish(part, slot->bytes.wide.sums()));
    }
    while (const Slot* const slot = oldest())
      if (!wait_for(*slot)) break;
  }

 private:
  static constexpr size_t none = ~size_t{0};
  struct Slot {
    PartBytes bytes;
    size_t part = none;
  };

  /// Where its place is known once its tree is made, a part is written there.
  void build(size_t part, Slot& slot) {
    const Subtree& where = all_.parts_[part].where;
    builder_.plan(where);
    const uint32_t place = all_.place_of_next(part);
    if (place == 0) {
      slot.bytes.start_apart(where);
      slot.part = part;
    } else {
      slot.bytes.start_in_place(all_.block_.data(), place);
    }
    builder_.write(slot.bytes);
    if (place != 0) all_.parts_[part].keep(slot.bytes.pieces);
  }

  /// Null when another thread has failed.
  Slot* free_slot() {
    const auto is_free = [](const Slot& slot) { return slot.part == none; };
    if (std::none_of(slots_.begin(), slots_.end(), is_free) && !wait_for(*oldest())) return nullptr;
    return &*std::find_if(slots_.begin(), slots_.end(), is_free);
  }

  /// Null if nothing waits.
  const Slot* oldest() const {
    const auto older = [](const Slot& a, const Slot& b) { return a.part < b.part; };
    const auto first = std::min_element(slots_.begin(), slots_.end(), older);
    return first->part == none ? nullptr : &*first;
  }

  bool wait_for(const Slot& slot) {
    const size_t placed = all_.wait_for_place(slot.part);
    move_before(placed);
    return placed > 0;
  }

  /// Moves the parts that have a place: those before `placed`.
  void move_before(size_t placed) {
    for (Slot& slot : slots_)
      if (slot.part < placed) all_.move(std::exchange(slot.part, none), slot.bytes);
  }

  PartsInOrder& all_;
  PartBuilder builder_;
  std::array<Slot, thread_slots> slots_;
};

PartsInOrder::PartsInOrder(const TriangleCurve& order, const TreeInput& input, std::span<Part> parts,
                           std::span<std::byte> block, uint32_t granule)
    : order_(order),
      input_(input),
      parts_(parts),
      block_(block),
      built_(parts.size()),
      place_(parts.size()),
      first_granule_(granule) {
  parallel_for(std::min<size_t>(thread_limit(), parts.size()), 1, [this](uint64_t, uint64_t) {
    try {
      Worker(*this).work();
    } catch (...) {
      give_up();
      throw;
    }
  });
}

/// The next part to build; as many as there are when none is left.
size_t PartsInOrder::take() {
  const std::lock_guard lock(mutex_);
  return failed_ || next_ == parts_.size() ? parts_.size() : next_++;
}

/// Where the part goes; 0 while one before it is not finished.
uint32_t PartsInOrder::place_of_next(size_t part) {
  const std::lock_guard lock(mutex_);
  return placed_ == part ? granule() : 0;
}

/// Gives places as far as parts are built; returns the first part without.
size_t PartsInOrder::finish(size_t part, const WideSums& sums) {
  std::unique_lock lock(mutex_);
  built_[part] = sums;
  for (; placed_ < parts_.size() && built_[placed_].granules > 0; ++placed_) {
    place_[placed_] = granule();
    sums_.add(built_[placed_]);
  }
  const size_t placed = placed_;
  const uint64_t begin = populated_, end = populated_ = std::max(populated_, page_after_next());
  lock.unlock();
  placed_more_.notify_all();
  populate(block_.data() + begin, end - begin);
  return placed;
}

/// Returns the first part without a place once that is behind `part`; 0 if a thread has failed.
size_t PartsInOrder::wait_for_place(size_t part) {
  std::unique_lock lock(mutex_);
  placed_more_.wait(lock, [&] { return failed_ || placed_ > part; });
  return failed_ ? 0 : placed_;
}

/// A page before it is needed: threads that write to a new page at the same time would each clear one.
uint64_t PartsInOrder::page_after_next() const {
  const uint64_t used = uint64_t{granule()} * granule_bytes;
  const uint64_t in_page = (reinterpret_cast<uintptr_t>(block_.data()) + used) % huge_page;
  return std::min<uint64_t>(block_.size(), used - in_page + 2 * huge_page);
}

void PartsInOrder::move(size_t part, PartBytes& bytes) {
  bytes.move_to(block_.data(), place_[part]);
  parts_[part].keep(bytes.pieces);
}

void PartsInOrder::give_up() {
  const std::lock_guard lock(mutex_);
  failed_ = true;
  placed_more_.notify_all();
}

}  // namespace rayloom::accel
