#pragma once

// Reproducible random input for the accel tests: the engine is fixed by the standard, the mappings are written here.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace rayloom::accel::test {

class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  uint64_t bits() { return engine_(); }
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(engine_() % count); }
  bool chance(uint32_t one_in) { return below(one_in) == 0; }

  /// Uniform in [low, high].
  float uniform(float low, float high) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return static_cast<float>(low + (double{high} - low) * unit);
  }

  /// Either sign, magnitude log-uniform in [2^low, 2^high).
  float scaled(int low, int high) {
    const int exponent = low + static_cast<int>(below(static_cast<uint32_t>(high - low)));
    return static_cast<float>(std::ldexp(double{uniform(1, 2)}, exponent)) * (chance(2) ? -1.0f : 1.0f);
  }

  /// Any finite float, all bit patterns alike.
  float any_finite() {
    while (true) {
      const float value = std::bit_cast<float>(static_cast<uint32_t>(engine_()));
      if (std::isfinite(value)) return value;
    }
  }

  /// `value` moved by up to `steps` floats up or down.
  float nudged(float value, uint32_t steps) {
    const float towards = chance(2) ? std::numeric_limits<float>::max() : std::numeric_limits<float>::lowest();
    for (uint32_t i = below(steps + 1); i > 0; --i) value = std::nextafter(value, towards);
    return value;
  }

 private:
  std::mt19937_64 engine_;
};

using Matrix = float[3][4];

/// Of 12 numbers of any size; some are 0, so that some have no inverse.
inline void random_matrix(Random& random, Matrix& m) {
  for (auto& row : m)
    for (float& x : row) x = random.chance(4) ? 0 : random.scaled(-6, 6);
}

}  // namespace rayloom::accel::test
