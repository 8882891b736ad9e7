#include <rayloom/accel/radix_sort.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>

namespace rayloom::accel {
namespace {

constexpr int digit_bits = 11;
constexpr size_t buckets = size_t{1} << digit_bits;
/// Keys a task counts and moves. A stable sort has one result, so this is free to choose.
constexpr size_t block_size = size_t{1} << 16;

using Counts = std::array<uint32_t, buckets>;

class RadixSort {
 public:
  explicit RadixSort(std::span<MortonKey> keys)
      : from_(keys), scratch_(keys.size()), to_(scratch_), counts_((keys.size() + block_size - 1) / block_size) {}

  void pass(int shift) {
    for_each_block([&](size_t block, std::span<const MortonKey> keys) {
      counts_[block].fill(0);
      for (const MortonKey& key : keys) ++counts_[block][digit(key, shift)];
    });
    if (!to_positions()) return;
    for_each_block([&](size_t block, std::span<const MortonKey> keys) {
      Counts& next = counts_[block];
      for (const MortonKey& key : keys) to_[next[digit(key, shift)]++] = key;
    });
    std::swap(from_, to_);
  }

  /// The sorted keys lie where they came from or in the scratch memory.
  void finish(std::span<MortonKey> keys) {
    if (from_.data() == keys.data()) return;
    for_each_block([&](size_t block, std::span<const MortonKey> part) {
      std::copy(part.begin(), part.end(), keys.data() + block * block_size);
    });
  }

 private:
  static size_t digit(const MortonKey& key, int shift) { return (key.code >> shift) & (buckets - 1); }

  template <class Body>
  void for_each_block(const Body& body) {
    parallel_for(from_.size(), block_size, [&](uint64_t begin, uint64_t end) {
      body(begin / block_size, std::span<const MortonKey>(from_).subspan(begin, end - begin));
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
  std::vector<Counts> counts_;
};

}  // namespace

void radix_sort(std::span<MortonKey> keys) {
  RadixSort sort(keys);
  for (int shift = 0; shift < 32; shift += digit_bits) sort.pass(shift);
  sort.finish(keys);
}

}  // namespace rayloom::accel
