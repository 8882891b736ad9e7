#include <rayloom/accel/build.h>
#include <rayloom/accel/scratch_vector.h>

#include <algorithm>
#include <mutex>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace rayloom::accel {
namespace {

constexpr size_t huge_page = size_t{2} << 20, small_page = 4096;
constexpr size_t least_kept = size_t{64} << 10;
constexpr size_t most_kept = size_t{256} << 20;

/// Of blocks from `least_kept` to a huge page few sizes are in use, so that they serve again.
size_t whole_blocks(size_t bytes) {
  const size_t unit = bytes < huge_page ? least_kept : huge_page;
  return (bytes + unit - 1) / unit * unit;
}

std::align_val_t alignment_of(size_t bytes) { return std::align_val_t{bytes < huge_page ? small_page : huge_page}; }

struct FreePages {
  size_t bytes;
  void operator()(void* memory) const { ::operator delete(memory, alignment_of(bytes)); }
};
using Pages = std::unique_ptr<void, FreePages>;

Pages allocate_pages(size_t bytes) {
  Pages memory(::operator new(bytes, alignment_of(bytes)), {bytes});
#if defined(__linux__)
  if (bytes >= huge_page) madvise(memory.get(), bytes, MADV_HUGEPAGE);  // a hint: failure costs time only
#endif
  return memory;
}

/// Freed blocks for the next build, so that it need not wait for the system to clear new pages.
class Pool {
 public:
  ~Pool() { release(); }

  /// The smallest block that fits without wasting half of itself; null when there is none.
  void* take(size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto best = blocks_.end();
    for (auto block = blocks_.begin(); block != blocks_.end(); ++block)
      if (block->bytes >= bytes && block->bytes <= 2 * bytes && (best == blocks_.end() || block->bytes < best->bytes))
        best = block;
    if (best == blocks_.end()) return nullptr;
    in_use_.push_back(*best);
    kept_ -= best->bytes;
    blocks_.erase(best);
    return in_use_.back().memory;
  }

  void* add(Pages memory, size_t bytes) {
    const std::lock_guard lock(mutex_);
    in_use_.reserve(in_use_.size() + 1);
    blocks_.reserve(blocks_.size() + in_use_.size() + 1);  // give_back() must not fail
    in_use_.push_back({memory.get(), bytes});
    return memory.release();
  }

  void give_back(void* memory) {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(in_use_.begin(), in_use_.end(), [&](const Block& block) { return block.memory == memory; });
    const Block block = *found;
    in_use_.erase(found);
    blocks_.push_back(block);
    kept_ += block.bytes;
    for (; kept_ > most_kept; blocks_.erase(blocks_.begin())) drop(blocks_.front());
  }

  void release() {
    const std::lock_guard lock(mutex_);
    for (const Block& block : blocks_) drop(block);
    blocks_.clear();
  }

 private:
  struct Block {
    void* memory;
    size_t bytes;
  };
  void drop(const Block& block) {
    kept_ -= block.bytes;
    FreePages{block.bytes}(block.memory);
  }

  std::mutex mutex_;
  std::vector<Block> blocks_, in_use_;  ///< oldest first
  size_t kept_ = 0;
};

Pool& pool() {
  static Pool instance;
  return instance;
}

}  // namespace

void* detail::allocate_scratch(size_t bytes) {
  if (bytes < least_kept) return ::operator new(bytes);
  const size_t whole = whole_blocks(bytes);
  if (void* const kept = pool().take(whole)) return kept;
  return pool().add(allocate_pages(whole), whole);
}

void detail::free_scratch(void* memory, size_t bytes) {
  if (bytes < least_kept)
    ::operator delete(memory);
  else
    pool().give_back(memory);
}

void release_build_scratch() { pool().release(); }

}  // namespace rayloom::accel
