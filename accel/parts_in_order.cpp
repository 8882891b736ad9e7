#include <rayloom/accel/parts_in_order.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace rayloom::accel {
namespace {

/// For each thread; all but one of its parts may wait for a slower one before them.
constexpr size_t thread_builders = 4;
constexpr uint64_t small_page = 4096, huge_page = uint64_t{2} << 20;

/// Has the system clear the pages of a range, whose bytes stay. A hint: failure costs time only.
void populate([[maybe_unused]] std::byte* begin, [[maybe_unused]] uint64_t bytes) {
#if defined(MADV_POPULATE_WRITE)
  const uint64_t in_page = reinterpret_cast<uintptr_t>(begin) % small_page;
  if (bytes > 0) madvise(begin - in_page, bytes + in_page, MADV_POPULATE_WRITE);
#endif
}

}  // namespace

void PartSums::add(const WideBytes& wide) {
  node_count += static_cast<uint32_t>(wide.nodes().size());
  leaf_count += wide.leaf_count();
  area += wide.area();
}

PartsInOrder::PartsInOrder(const TriangleCurve& order, const TreeInput& input, std::span<Part> parts,
                           std::span<std::byte> block, uint32_t granule)
    : order_(order),
      input_(input),
      parts_(parts),
      block_(block),
      unmade_(thread_builders * thread_limit()),
      built_(parts.size()),
      place_(parts.size()),
      granule_(granule) {
  parallel_for(std::min<size_t>(thread_limit(), parts.size()), 1, [this](uint64_t, uint64_t) { work(); });
}

void PartsInOrder::work() {
  try {
    for (Task task = take(); task.builder; task = take()) {
      task.builder->build(parts_[task.part].where);
      move(place(std::move(task)));
    }
  } catch (...) {
    give_up();
    throw;
  }
}

/// A part is taken with a builder, so the first part without a place is always being built: waiting for others'
/// builders comes to an end.
PartsInOrder::Task PartsInOrder::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return next_ == parts_.size() || !free_.empty() || unmade_ > 0; });
  if (next_ == parts_.size()) return {};
  Task task{next_++, nullptr};
  if (next_ == parts_.size()) changed_.notify_all();
  if (free_.empty()) {
    --unmade_;
    task.builder = std::make_unique<PartBuilder>(order_, input_);
  } else {
    task.builder = std::move(free_.back());
    free_.pop_back();
  }
  return task;
}

PartsInOrder::Share PartsInOrder::place(Task task) {
  const std::lock_guard lock(mutex_);
  built_[task.part] = std::move(task.builder);
  const size_t first = placed_;
  for (; placed_ < parts_.size() && built_[placed_]; ++placed_) {
    const WideBytes& wide = built_[placed_]->wide();
    place_[placed_] = std::exchange(granule_, granule_ + wide.granule());
    sums_.add(wide);
  }
  const uint64_t begin = populated_;
  populated_ = std::max(populated_, page_after_next());
  return {first, placed_, begin, populated_};
}

/// A page before it is needed: threads that write to a new page at the same time would each clear one.
uint64_t PartsInOrder::page_after_next() const {
  const uint64_t used = uint64_t{granule_} * granule_bytes;
  const uint64_t in_page = (reinterpret_cast<uintptr_t>(block_.data()) + used) % huge_page;
  return std::min<uint64_t>(block_.size(), used - in_page + 2 * huge_page);
}

void PartsInOrder::move(const Share& share) {
  populate(block_.data() + share.begin, share.end - share.begin);
  for (size_t part = share.first; part < share.last; ++part) {
    parts_[part].pieces = built_[part]->move_to(block_.data(), place_[part]);
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(built_[part]));
    changed_.notify_one();
  }
}

void PartsInOrder::give_up() {
  const std::lock_guard lock(mutex_);
  next_ = parts_.size();
  changed_.notify_all();
}

}  // namespace rayloom::accel
