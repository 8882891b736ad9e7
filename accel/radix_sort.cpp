#include <rayloom/accel/radix_sort.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>

namespace rayloom::accel {
namespace {

constexpr int digit_bits = 11, passes = 3;
constexpr size_t buckets = size_t{1} << digit_bits;
/// Keys a task counts and moves; a single thread takes all. A stable sort has one result, so this is free to choose.
constexpr size_t shared_block_size = size_t{1} << 16;

using Counts = std::array<uint32_t, buckets>;

class RadixSort {
 public:
  explicit RadixSort(std::span<MortonKey> keys)
      : from_(keys),
        scratch_(keys.size()),
        to_(scratch_),
        block_size_(thread_limit() == 1 ? keys.size() : shared_block_size),
        counts_(keys.empty() ? 0 : (keys.size() + block_size_ - 1) / block_size_) {}

  void sort() {
    if (counts_.size() == 1) return sort_one_block();
    for (int pass = 0; pass < passes; ++pass) {
      for_each_block([&](size_t block, std::span<const MortonKey> keys) { count(keys, pass, counts_[block]); });
      if (to_positions()) move(pass);
    }
  }

  /// The sorted keys lie where they came from or in the scratch memory.
  void finish(std::span<MortonKey> keys) {
    if (from_.data() == keys.data()) return;
    for_each_block([&](size_t block, std::span<const MortonKey> part) {
      std::copy(part.begin(), part.end(), keys.data() + block * block_size_);
    });
  }

 private:
  static size_t digit(const MortonKey& key, int pass) { return (key.code >> pass * digit_bits) & (buckets - 1); }

  static void count(std::span<const MortonKey> keys, int pass, Counts& counts) {
    counts.fill(0);
    for (const MortonKey& key : keys) ++counts[digit(key, pass)];
  }

  /// Moving keys within one block does not change its counts: all are taken at once.
  void sort_one_block() {
    std::array<Counts, passes> counts{};
    for (const MortonKey& key : from_)
      for (int pass = 0; pass < passes; ++pass) ++counts[static_cast<size_t>(pass)][digit(key, pass)];
    for (int pass = 0; pass < passes; ++pass) {
      counts_[0] = counts[static_cast<size_t>(pass)];
      if (to_positions()) move(pass);
    }
  }

  void move(int pass) {
    for_each_block([&](size_t block, std::span<const MortonKey> keys) {
      Counts& next = counts_[block];
      for (const MortonKey& key : keys) to_[next[digit(key, pass)]++] = key;
    });
    std::swap(from_, to_);
  }

  template <class Body>
  void for_each_block(const Body& body) {
    parallel_for(from_.size(), block_size_, [&](uint64_t begin, uint64_t end) {
      body(begin / block_size_, std::span<const MortonKey>(from_).subspan(begin, end - begin));
    });
  }

  /// Turns counts into each block's first position in each bucket. False when all keys share one bucket.
  bool to_positions() {
    uint32_t position = 0;
    for (size_t bucket = 0; bucket < buckets; ++bucket) {
      const uint32_t begin = position;
      for (Counts& counts : counts_) position += std::exchange(counts[bucket], position);
      if (position - begin == from_.size()) return false;
    }
    return true;
  }

  std::span<MortonKey> from_;
  ScratchVector<MortonKey> scratch_;
  std::span<MortonKey> to_;
  size_t block_size_;
  std::vector<Counts> counts_;
};

}  // namespace

void radix_sort(std::span<MortonKey> keys) {
  RadixSort sort(keys);
  sort.sort();
  sort.finish(keys);
}

}  // namespace rayloom::accel
