#pragma once

// Choosing one of many with given weights, by inverting a cumulative table. Its entries are multiples of 2^-24, as the
// random numbers are: each choice then has exactly the probability the table states, and none with a positive weight
// has less than 2^-24.

#include <cstdint>
#include <span>
#include <vector>

namespace rayloom::shaders {

/// Appends weights.size() + 1 ascending entries from 0 to 1. Weights are finite and not negative, at most 2^23 of them
/// positive; all zero counts as all equal. Returns the sum of the weights.
double append_cumulative(std::span<const float> weights, std::vector<float>& table);

struct Choice {
  uint32_t index;
  float probability;
  float offset;  ///< where in its interval u fell, 0..1: the digits of u the choice has not used up
};

/// Inverts the `count` intervals whose entries start at table[first]. u in [0, 1). `Table` is anything with operator[].
template <typename Table>
Choice choose(const Table& table, uint32_t first, uint32_t count, float u) {
  uint32_t low = 0, high = count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (u < table[first + middle] ? high : low) = middle;
  }
  const float begin = table[first + low];
  const float probability = table[first + low + 1] - begin;
  return {low, probability, (u - begin) / probability};
}

}  // namespace rayloom::shaders
