#pragma once

// The random numbers of a path. Owen-scrambled Sobol points, padded: every draw takes the first two (or four)
// dimensions of the sequence with an index shuffle and scrambles of its own, so any number of well stratified draws can
// follow each other (Burley 2020). Or independent numbers, to measure the former against (docs/image-error.md).

#include <rayloom/shaders/hash.h>
#include <rayloom/shaders/sampler_kind.h>
#include <rayloom/shaders/sobol.h>
#include <rayloom/shaders/vector_math.h>

namespace rayloom::shaders {

/// Random numbers of one sample of one pixel: a function of (pixel, sample, seed, kind) and the number of draws before.
/// Plain data, so that it can travel in a payload. Each coordinate lies in [0, 1) and has 24 bits.
class Sampler {
 public:
  Sampler() = default;
  Sampler(uint2 pixel, uint32_t sample, uint32_t seed, SamplerKind kind = SamplerKind::owen_sobol)
      : key_(hash_combine(seed, (uint64_t{pixel.y} << 32) | pixel.x)),
        sample_(sample),
        independent_(kind == SamplerKind::independent) {}

  float2 next_2d() {
    const uint64_t seed = next_seed();
    if (independent_) return independent_pair(hash_combine(seed, sample_));
    const Draw draw = shuffled(seed);
    return {coordinate(sobol_0(draw.index), draw.seed), coordinate(sobol_1(draw.index), mix64(draw.seed + 1))};
  }

  float4 next_4d() {
    const uint64_t seed = next_seed();
    if (independent_) {
      const uint64_t bits = hash_combine(seed, sample_);
      return {independent_pair(bits), independent_pair(mix64(bits + 1))};
    }
    const Draw draw = shuffled(seed);
    return {coordinate(sobol_0(draw.index), draw.seed), coordinate(sobol_1(draw.index), mix64(draw.seed + 1)),
            coordinate(sobol_2(draw.index), mix64(draw.seed + 2)),
            coordinate(sobol_3(draw.index), mix64(draw.seed + 3))};
  }

  /// Names (pixel, sample, seed) and the draws so far, for CandidateKey.
  uint64_t path_key() const { return hash_combine(key_, (uint64_t{sample_} << 32) | draws_); }
  uint32_t sample() const { return sample_; }

 private:
  struct Draw {
    uint32_t index;
    uint64_t seed;
  };

  uint64_t next_seed() {
    ++draws_;
    return hash_combine(key_, draws_);
  }
  Draw shuffled(uint64_t seed) const { return {shuffle_index(sample_, static_cast<uint32_t>(seed)), mix64(seed)}; }
  static float coordinate(uint32_t fraction, uint64_t seed) {
    return unit_float(owen_scramble(fraction, static_cast<uint32_t>(seed >> 32)));
  }
  static float2 independent_pair(uint64_t bits) {
    return {unit_float(static_cast<uint32_t>(bits >> 32)), unit_float(static_cast<uint32_t>(bits))};
  }

  uint64_t key_ = 0;
  uint32_t sample_ = 0;
  uint32_t draws_ : 31 = 0;  // with the bit below in one word: payloads keep their size
  uint32_t independent_ : 1 = 0;
};

}  // namespace rayloom::shaders
