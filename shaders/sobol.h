#pragma once

// The first four dimensions of Sobol's sequence (Joe and Kuo 2008, "Constructing Sobol sequences with better
// two-dimensional projections": primitive polynomials x, x+1, x^2+x+1, x^3+x+1, initial numbers 1; 1,3; 1,3,1), as
// 32-bit fractions, and Owen's scrambling of them.

#include <array>
#include <cstdint>

namespace rayloom::shaders {

constexpr uint32_t reverse_bits(uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// Dimension 0: van der Corput's radical inverse.
constexpr uint32_t sobol_0(uint32_t index) { return reverse_bits(index); }

/// Dimension 1: its generator is Pascal's triangle modulo 2, which factors into five shifts.
constexpr uint32_t sobol_1(uint32_t index) {
  uint32_t x = reverse_bits(index);
  x ^= (x & 0x0000ffffu) << 16;
  x ^= (x & 0x00ff00ffu) << 8;
  x ^= (x & 0x0f0f0f0fu) << 4;
  x ^= (x & 0x33333333u) << 2;
  return x ^ ((x & 0x55555555u) << 1);
}

namespace detail {

/// Bratley and Fox 1988: v_i = a_1 v_{i-1} ^ ... ^ a_{s-1} v_{i-s+1} ^ v_{i-s} ^ (v_{i-s} >> s).
constexpr std::array<uint32_t, 32> sobol_directions(int degree, uint32_t inner_coefficients,
                                                    std::array<uint32_t, 3> initial) {
  std::array<uint32_t, 32> v{};
  for (int i = 0; i < 32; ++i) {
    if (i < degree) {
      v[i] = initial[i] << (31 - i);
      continue;
    }
    v[i] = v[i - degree] ^ (v[i - degree] >> degree);
    for (int k = 1; k < degree; ++k)
      if ((inner_coefficients >> (degree - 1 - k)) & 1u) v[i] ^= v[i - k];
  }
  return v;
}

/// The exclusive-ors of a direction's 32 numbers, a byte of the index at a time.
using SobolTable = std::array<std::array<uint32_t, 256>, 4>;
constexpr SobolTable sobol_table(const std::array<uint32_t, 32>& directions) {
  SobolTable table{};
  for (int byte = 0; byte < 4; ++byte)
    for (int value = 0; value < 256; ++value)
      for (int bit = 0; bit < 8; ++bit)
        if ((value >> bit) & 1) table[byte][value] ^= directions[8 * byte + bit];
  return table;
}

inline constexpr SobolTable sobol_table_2 = sobol_table(sobol_directions(2, 0b1, {1, 3, 0}));
inline constexpr SobolTable sobol_table_3 = sobol_table(sobol_directions(3, 0b01, {1, 3, 1}));

constexpr uint32_t sobol_lookup(const SobolTable& table, uint32_t index) {
  return table[0][index & 255] ^ table[1][(index >> 8) & 255] ^ table[2][(index >> 16) & 255] ^ table[3][index >> 24];
}

}  // namespace detail

constexpr uint32_t sobol_2(uint32_t index) { return detail::sobol_lookup(detail::sobol_table_2, index); }
constexpr uint32_t sobol_3(uint32_t index) { return detail::sobol_lookup(detail::sobol_table_3, index); }

/// Permutes integers so that bit i of the result depends on bits 0..i alone: a nested uniform scramble, seen from the
/// low end (Laine and Karras 2011; constants after N. Vegdahl 2021, "Building a Better LK Hash").
constexpr uint32_t scramble_from_low_bit(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

/// Owen's scramble of a 32-bit fraction: each digit is flipped or not depending on the digits above it.
constexpr uint32_t owen_scramble(uint32_t fraction, uint32_t seed) {
  return reverse_bits(scramble_from_low_bit(reverse_bits(fraction), seed));
}

/// Permutes sample indices likewise (Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 10:4): any aligned run
/// of 2^k indices stays an aligned run, so that its samples remain a (0, k, 2)-net.
constexpr uint32_t shuffle_index(uint32_t index, uint32_t seed) { return owen_scramble(index, seed); }

}  // namespace rayloom::shaders
