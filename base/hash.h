#pragma once

// A 64-bit hash with the same value on every machine and in every release: for image and capture hashes in tests, and
// for random numbers drawn by hashing a key instead of advancing a state.

#include <bit>
#include <cstdint>
#include <ranges>
#include <type_traits>

namespace rayloom {

/// A bijection that spreads every input bit over the result: the finaliser of SplitMix64 (Steele, Lea, Flood 2014,
/// constants of Stafford's "Mix13").
constexpr uint64_t mix64(uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// Takes numbers and ranges of numbers in order. Each number counts by its value's bits, so 1, 1u and true are equal,
/// 0.0 and -0.0 are not, and the machine's byte order does not matter. A range adds its length too.
class Hash64 {
 public:
  constexpr explicit Hash64(uint64_t seed = 0) noexcept : state_(seed) {}

  template <typename T>
  constexpr Hash64& add(const T& item) noexcept {
    if constexpr (std::is_enum_v<T>) {
      add(static_cast<std::underlying_type_t<T>>(item));
    } else if constexpr (std::is_same_v<T, float>) {
      add_word(std::bit_cast<uint32_t>(item));
    } else if constexpr (std::is_same_v<T, double>) {
      add_word(std::bit_cast<uint64_t>(item));
    } else if constexpr (std::is_integral_v<T>) {
      add_word(static_cast<uint64_t>(item));
    } else {
      static_assert(std::ranges::input_range<T>, "hash the members of a struct one by one: padding has no value");
      uint64_t length = 0;
      for (const auto& element : item) add(element), ++length;
      add_word(length);
    }
    return *this;
  }
  constexpr uint64_t value() const noexcept { return mix64(state_); }

 private:
  constexpr void add_word(uint64_t word) noexcept { state_ = mix64((state_ + 0x9E3779B97F4A7C15u) ^ word); }

  uint64_t state_;
};

/// Hash of several numbers, in order: hash64(pixel, sample, dimension).
template <typename... T>
constexpr uint64_t hash64(const T&... items) noexcept {
  Hash64 hash;
  (hash.add(items), ...);
  return hash.value();
}

/// Uniform in [0, 1), a multiple of 2^-24, from the upper bits of a hash.
constexpr float unit_float(uint64_t hash) noexcept { return static_cast<float>(hash >> 40) * 0x1p-24f; }

}  // namespace rayloom
