#include <rayloom/tools/bench/numerics/tally.h>

#include <algorithm>
#include <bit>

namespace rayloom::bench::numerics {
namespace {

constexpr uint32_t dropped_bits = 15;

uint32_t bucket_of(double value) { return std::bit_cast<uint32_t>(static_cast<float>(value)) >> dropped_bits; }

/// The largest float of a bucket.
double end_of(uint32_t bucket) {
  return double{std::bit_cast<float>((bucket << dropped_bits) | ((1u << dropped_bits) - 1))};
}

}  // namespace

void Histogram::add(double value) {
  const double kept = std::isnan(value) ? std::numeric_limits<double>::infinity() : std::max(value, 0.0);
  ++count_[bucket_of(kept)];
  ++size_;
  largest_ = std::max(largest_, kept);
}

void Histogram::merge(const Histogram& other) {
  for (const auto& [bucket, count] : other.count_) count_[bucket] += count;
  size_ += other.size_;
  largest_ = std::max(largest_, other.largest_);
}

double Histogram::quantile(double fraction) const {
  const auto wanted = static_cast<uint64_t>(fraction * static_cast<double>(size_));
  uint64_t seen = 0;
  for (const auto& [bucket, count] : count_) {
    seen += count;
    if (seen < wanted || seen == 0) continue;
    const double end = end_of(bucket);
    return end < largest_ ? end : largest_;  // not NaN, which the bucket of infinity ends with
  }
  return largest_;
}

void Tally::merge(const Tally& other) {
  cases += other.cases;
  for (size_t i = 0; i < counters; ++i) {
    count[i] += other.count[i];
    most[i] = std::max(most[i], other.most[i]);
  }
  values.merge(other.values);
  examples.insert(examples.end(), other.examples.begin(), other.examples.end());
  std::sort(examples.begin(), examples.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  if (examples.size() > most_examples) examples.resize(most_examples);
}

}  // namespace rayloom::bench::numerics
