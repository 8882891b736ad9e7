#pragma once

// What a sample of cases came to: counts, extremes, and the first cases that failed. Merging is independent of order,
// so a tally is the same for any number of threads.

#include <rayloom/tests/accel/random.h>
#include <rayloom/tools/bench/numerics/failing_ray.h>

#include <array>
#include <map>

namespace rayloom::bench::numerics {

using accel::test::Random;

/// Values of at least 0, counted by the 1/256 of an octave they lie in: as much memory for 10^10 as for a thousand.
class Histogram {
 public:
  void add(double value);
  void merge(const Histogram& other);
  uint64_t size() const { return size_; }
  double largest() const { return largest_; }
  /// What `fraction` of the values do not exceed, at most 1/256 too large; 1: the largest. 0 without any.
  double quantile(double fraction) const;

 private:
  std::map<uint32_t, uint64_t> count_;  ///< by the upper 17 bits of the float
  uint64_t size_ = 0;
  double largest_ = 0;
};

struct Tally {
  static constexpr size_t counters = 8;
  static constexpr size_t most_examples = 8;

  uint64_t cases = 0;
  std::array<uint64_t, counters> count{};
  std::array<double, counters> most{};  ///< largest value seen, at least 0
  Histogram values;
  std::vector<FailingRay> examples;  ///< the first failing cases; row and seed are filled in by the row's run
  uint64_t index = 0;                ///< of the current case

  void grow(size_t i, double value) { most[i] = std::max(most[i], std::isnan(value) ? INFINITY : value); }
  void add(size_t counter, bool happened) { count[counter] += happened; }

  /// Counts a failure and keeps the ray with the triangles that show it.
  void fail(size_t counter, const Ray& ray, const std::vector<Triangle>& triangles) {
    ++count[counter];
    const bool is_kept = !examples.empty() && examples.back().index == index;
    if (examples.size() < most_examples && !is_kept) examples.push_back({{}, 0, 0, index, ray, triangles});
  }

  void merge(const Tally& other);
};

}  // namespace rayloom::bench::numerics
