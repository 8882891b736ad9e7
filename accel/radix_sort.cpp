#include <rayloom/accel/radix_sort.h>
#include <rayloom/accel/read_ahead.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <array>

namespace rayloom::accel {
namespace {

/// Keys a task counts and moves; a single thread takes all. A stable sort has one result, so this is free to choose.
constexpr size_t shared_block_size = size_t{1} << 16;
/// Buckets a task sorts.
constexpr size_t task_buckets = 16;
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
    for_each_block([this](Counts& counts, std::span<const MortonKey> keys) { count(keys, counts); });
    to_positions();
    for_each_block([this](Counts& next, std::span<const MortonKey> keys) {
      for (const MortonKey& key : keys) {
        read_ahead(&key);
        to_[next[digit<shared_bits>(key, shift_)]++] = key;
      }
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

  /// Neighbours in the input are neighbours on the curve: counting one bucket twice running would wait for itself.
  void count(std::span<const MortonKey> keys, Counts& counts) const {
    std::array<Counts, 4> parts{};
    size_t i = 0;
    for (; i + parts.size() <= keys.size(); i += parts.size()) {
      read_ahead(&keys[i]);
      for (size_t k = 0; k < parts.size(); ++k) ++parts[k][digit<shared_bits>(keys[i + k], shift_)];
    }
    for (; i < keys.size(); ++i) ++parts[0][digit<shared_bits>(keys[i], shift_)];
    for (size_t bucket = 0; bucket < shared_buckets; ++bucket)
      counts[bucket] = parts[0][bucket] + parts[1][bucket] + parts[2][bucket] + parts[3][bucket];
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

void insert_all(std::span<MortonKey> keys) {
  for (size_t i = 1; i < keys.size(); ++i) {
    const MortonKey key = keys[i];
    size_t place = i;
    for (; place > 0 && keys[place - 1].code > key.code; --place) keys[place] = keys[place - 1];
    keys[place] = key;
  }
}

/// Sorts keys that agree in all but the low `passes * bits` bits; `spare` is as long.
template <int passes, int bits>
void sort_locally(std::span<MortonKey> keys, MortonKey* spare) {
  if (keys.size() < insertion_size) return insert_all(keys);
  std::array<std::array<uint32_t, size_t{1} << bits>, passes> counts{};
  for (const MortonKey& key : keys) {
    read_ahead(&key);
    for (int pass = 0; pass < passes; ++pass) ++counts[pass][digit<bits>(key, pass * bits)];
  }
  std::span<const MortonKey> from = keys;
  MortonKey* to = spare;
  for (int pass = 0; pass < passes; ++pass) {
    auto& next = counts[pass];
    uint32_t position = 0;
    for (uint32_t& count : next) position += std::exchange(count, position);
    for (const MortonKey& key : from) to[next[digit<bits>(key, pass * bits)]++] = key;
    from = {to, keys.size()};
    to = to == spare ? keys.data() : spare;
  }
  if (passes % 2 == 1) std::copy_n(spare, keys.size(), keys.data());
}

/// Fewer and longer passes where there are keys enough for their tables.
void sort_bucket(std::span<MortonKey> bucket, MortonKey* spare) {
  if (bucket.size() < 1024) return sort_locally<3, 7>(bucket, spare);
  sort_locally<2, 11>(bucket, spare);
}

/// The keys of a bucket that no cache holds; `spare` is as long.
void sort_large_bucket(std::span<MortonKey> keys, std::span<MortonKey> spare, const OnSorted& on_sorted) {
  const Distribution distribution(keys, spare, 10);
  parallel_for(shared_buckets, task_buckets, [&](size_t first, size_t last) {
    for (size_t bucket = first; bucket < last; ++bucket) {
      const size_t begin = distribution.begin(bucket);
      const auto sorted = keys.subspan(begin, distribution.size(bucket)), from = spare.subspan(begin, sorted.size());
      sort_locally<2, 5>(from, sorted.data());
      std::copy(from.begin(), from.end(), sorted.begin());
      if (!sorted.empty()) on_sorted(sorted);
    }
  });
}

class BucketSort {
 public:
  BucketSort(ScratchVector<MortonKey>& keys, const OnSorted& on_sorted)
      : buckets_(keys.size()), distribution_(keys, buckets_, 21), on_sorted_(on_sorted) {
    for (size_t bucket = 0; bucket < shared_buckets; ++bucket)
      if (const size_t size = distribution_.size(bucket); size > local_size)
        sort_large_bucket(keys_of(bucket), std::span(keys).subspan(distribution_.begin(bucket), size), on_sorted);
    parallel_for(shared_buckets, task_buckets, [this](size_t first, size_t last) { sort_small(first, last); });
    keys.swap(buckets_);
  }

 private:
  std::span<MortonKey> keys_of(size_t bucket) {
    return std::span(buckets_).subspan(distribution_.begin(bucket), distribution_.size(bucket));
  }

  void sort_small(size_t first, size_t last) {
    size_t largest = 0;
    for (size_t bucket = first; bucket < last; ++bucket)
      if (const size_t size = distribution_.size(bucket); size <= local_size) largest = std::max(largest, size);
    ScratchVector<MortonKey> spare(largest);
    for (size_t bucket = first; bucket < last; ++bucket) {
      const std::span<MortonKey> keys = keys_of(bucket);
      if (keys.empty() || keys.size() > local_size) continue;
      sort_bucket(keys, spare.data());
      on_sorted_(keys);
    }
  }

  ScratchVector<MortonKey> buckets_;
  Distribution distribution_;
  const OnSorted& on_sorted_;
};

}  // namespace

void radix_sort(ScratchVector<MortonKey>& keys, const OnSorted& on_sorted) {
  if (keys.size() > local_size) {
    BucketSort(keys, on_sorted);
  } else if (!keys.empty()) {
    ScratchVector<MortonKey> spare(keys.size());
    sort_locally<4, 8>(keys, spare.data());
    on_sorted(keys);
  }
}

}  // namespace rayloom::accel
