#include <rayloom/accel/radix_sort.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>

namespace rayloom::accel {
namespace {

/// Keys a task counts and moves; a single thread takes all. A stable sort has one result, so this is free to choose.
constexpr size_t shared_block_size = size_t{1} << 16;
/// Buckets a task sorts.
constexpr size_t task_buckets = 4;
/// So many keys and their copies stay in a core's cache.
constexpr size_t local_size = size_t{1} << 15;
/// Fewer are inserted one by one.
constexpr size_t insertion_size = 24;

constexpr int shared_bits = 11;
constexpr size_t shared_buckets = size_t{1} << shared_bits;

template <int bits>
size_t digit(const MortonKey& key, int shift) {
  return (key.code >> shift) & ((1u << bits) - 1);
}

/// Of each bucket, by block; then where the block's keys go.
using Counts = std::array<uint32_t, shared_buckets>;

/// Moves keys to their buckets by the 11 bits from `shift` on, in parallel; gives where buckets begin, and the end.
class Distribution {
 public:
  Distribution(std::span<const MortonKey> from, std::span<MortonKey> to, int shift)
      : from_(from), to_(to), shift_(shift), block_size_(thread_limit() == 1 ? from.size() : shared_block_size) {
    counts_.resize((from.size() + block_size_ - 1) / block_size_);
    for_each_block([this](Counts& counts, std::span<const MortonKey> keys) {
      counts.fill(0);
      for (const MortonKey& key : keys) ++counts[digit<shared_bits>(key, shift_)];
    });
    to_positions();
    for_each_block([this](Counts& next, std::span<const MortonKey> keys) {
      for (const MortonKey& key : keys) to_[next[digit<shared_bits>(key, shift_)]++] = key;
    });
  }

  size_t begin(size_t bucket) const { return begins_[bucket]; }
  size_t size(size_t bucket) const { return begins_[bucket + 1] - begins_[bucket]; }

 private:
  template <class Body>
  void for_each_block(const Body& body) {
    parallel_for(from_.size(), block_size_, [&](uint64_t begin, uint64_t end) {
      body(counts_[begin / block_size_], from_.subspan(begin, end - begin));
    });
  }

  void to_positions() {
    Counts next{};
    for (const Counts& counts : counts_)
      for (size_t bucket = 0; bucket < shared_buckets; ++bucket) next[bucket] += counts[bucket];
    uint32_t position = 0;
    for (size_t bucket = 0; bucket < shared_buckets; ++bucket) {
      begins_[bucket] = position;
      position += std::exchange(next[bucket], position);
    }
    begins_[shared_buckets] = position;
    for (Counts& counts : counts_)
      for (size_t bucket = 0; bucket < shared_buckets; ++bucket)
        next[bucket] += std::exchange(counts[bucket], next[bucket]);
  }

  std::span<const MortonKey> from_;
  std::span<MortonKey> to_;
  int shift_;
  size_t block_size_;
  std::vector<Counts> counts_;
  std::array<uint32_t, shared_buckets + 1> begins_;
};

void insert_all(std::span<const MortonKey> from, MortonKey* to) {
  for (size_t i = 0; i < from.size(); ++i) {
    const MortonKey key = from[i];
    size_t place = i;
    for (; place > 0 && to[place - 1].code > key.code; --place) to[place] = to[place - 1];
    to[place] = key;
  }
}

/// Sorts keys that agree in all but the low `passes * bits` bits. They end up in `to` after an odd number of passes.
template <int passes, int bits>
void sort_locally(std::span<MortonKey> from, std::span<MortonKey> to) {
  if (from.size() < insertion_size) return insert_all(from, passes % 2 == 0 ? from.data() : to.data());
  std::array<std::array<uint32_t, size_t{1} << bits>, passes> counts{};
  for (const MortonKey& key : from)
    for (int pass = 0; pass < passes; ++pass) ++counts[pass][digit<bits>(key, pass * bits)];
  for (int pass = 0; pass < passes; ++pass) {
    auto& next = counts[pass];
    uint32_t position = 0;
    for (uint32_t& count : next) position += std::exchange(count, position);
    for (const MortonKey& key : from) to[next[digit<bits>(key, pass * bits)]++] = key;
    std::swap(from, to);
  }
}

/// Sorts by the low 21 bits, from `from` to `to`.
void sort_bucket(std::span<MortonKey> from, std::span<MortonKey> to) {
  if (from.size() <= local_size) return sort_locally<3, 7>(from, to);
  const Distribution distribution(from, to, 10);
  parallel_for(shared_buckets, task_buckets, [&](size_t first, size_t last) {
    for (size_t bucket = first; bucket < last; ++bucket) {
      const size_t begin = distribution.begin(bucket), size = distribution.size(bucket);
      sort_locally<2, 5>(to.subspan(begin, size), from.subspan(begin, size));
    }
  });
}

}  // namespace

void radix_sort(std::span<MortonKey> keys) {
  ScratchVector<MortonKey> scratch(keys.size());
  if (keys.size() <= local_size) return sort_locally<4, 8>(keys, scratch);
  const std::span<MortonKey> from(scratch);
  const Distribution distribution(keys, from, 21);
  const auto sort_if = [&](size_t bucket, bool large) {
    const size_t begin = distribution.begin(bucket), size = distribution.size(bucket);
    if ((size > local_size) == large) sort_bucket(from.subspan(begin, size), keys.subspan(begin, size));
  };
  for (size_t bucket = 0; bucket < shared_buckets; ++bucket) sort_if(bucket, true);
  parallel_for(shared_buckets, task_buckets, [&](size_t first, size_t last) {
    for (size_t bucket = first; bucket < last; ++bucket) sort_if(bucket, false);
  });
}

}  // namespace rayloom::accel
