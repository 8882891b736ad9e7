#pragma once

// Integer hashes: the source of every random number here. A number is a function of what it is for, never of when it is
// drawn, so pictures do not depend on the order of execution.

#include <rayloom/base/hash.h>

#include <cstdint>

namespace rayloom::shaders {

constexpr uint64_t hash_combine(uint64_t state, uint64_t value) {
  return mix64(state + 0x9e3779b97f4a7c15u + mix64(value));
}

/// [0, 1) with 24 bits: the top ones, so that strata of a radical inverse keep their place.
constexpr float unit_float(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }
using rayloom::unit_float;  // of 64 bits

/// What decides whether a candidate hit of a partly transparent primitive counts. It names the candidate alone, so the
/// verdict is the same in whatever order, and however often, traversal asks (guarantee G3b).
struct CandidateKey {
  uint64_t path;  ///< (pixel, sample, seed), and the ray's place on its path
  uint32_t instance, geometry, primitive;
};

constexpr float candidate_random(const CandidateKey& key) {
  uint64_t state = hash_combine(key.path, (uint64_t{key.instance} << 32) | key.geometry);
  return unit_float(hash_combine(state, key.primitive));
}

}  // namespace rayloom::shaders
