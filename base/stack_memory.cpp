#include <rayloom/base/stack_memory.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

namespace rayloom::detail {
namespace {

std::byte* map_stack(std::size_t bytes) {
  const std::size_t page = page_bytes();
  void* const memory = mmap(nullptr, page + bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  std::byte* const stack = static_cast<std::byte*>(memory) + page;
  if (mprotect(stack, bytes, PROT_READ | PROT_WRITE) == 0) return stack;
  munmap(memory, page + bytes);
  throw std::bad_alloc();
}

void unmap_stack(std::byte* stack, std::size_t bytes) { munmap(stack - page_bytes(), bytes + page_bytes()); }

/// Stacks out of use.
class KeptStacks {
 public:
  static KeptStacks& instance() {
    static auto* const kept = new KeptStacks;  // never destroyed: threads may outlive static destructors
    return *kept;
  }

  /// Null: there is none of this size.
  std::byte* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(stacks_.rbegin(), stacks_.rend(), [&](const Stack& stack) { return stack.bytes == bytes; });
    if (found == stacks_.rend()) return nullptr;
    std::byte* const begin = found->begin;
    bytes_ -= bytes;
    stacks_.erase(std::next(found).base());
    return begin;
  }

  /// In place of those given back longest ago, where there would be too many.
  void keep(std::byte* stack, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (bytes > most_bytes_) return unmap_stack(stack, bytes);
    while (bytes > most_bytes_ - bytes_ || stacks_.size() == stacks_.capacity()) drop_oldest();
    stacks_.push_back({stack, bytes});
    bytes_ += bytes;
  }

 private:
  struct Stack {
    std::byte* begin;
    std::size_t bytes;
  };

  void drop_oldest() {
    const Stack oldest = stacks_.front();
    stacks_.erase(stacks_.begin());
    bytes_ -= oldest.bytes;
    unmap_stack(oldest.begin, oldest.bytes);
  }

  /// What a core has in use: lanes of two warps, and some more than the usual 256 KiB for each.
  static constexpr std::size_t stacks_a_core = 128, bytes_a_core = stacks_a_core * 320 * 1024;

  KeptStacks() : most_bytes_(cores() * bytes_a_core) { stacks_.reserve(cores() * stacks_a_core); }
  static std::size_t cores() { return std::max(1u, std::thread::hardware_concurrency()); }

  std::size_t most_bytes_, bytes_ = 0;
  std::vector<Stack> stacks_;  // the last one given back on top
  std::mutex mutex_;
};

}  // namespace

std::size_t page_bytes() {
  static const auto bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return bytes;
}

std::byte* take_stack(std::size_t bytes) {
  std::byte* const kept = KeptStacks::instance().take(bytes);
  return kept ? kept : map_stack(bytes);
}

void give_back_stack(std::byte* stack, std::size_t bytes) noexcept { KeptStacks::instance().keep(stack, bytes); }

}  // namespace rayloom::detail
