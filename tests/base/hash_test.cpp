#include <rayloom/base/hash.h>

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <set>
#include <vector>

using namespace rayloom;

TEST_CASE("mix64 is SplitMix64's finaliser", "[hash]") {
  // The first outputs of SplitMix64 seeded with 0, as published with the generator.
  constexpr uint64_t step = 0x9E3779B97F4A7C15u;
  CHECK(mix64(step) == 0xE220A8397B1DCDAFu);
  CHECK(mix64(2 * step) == 0x6E789E6AA1B965F4u);
  CHECK(mix64(3 * step) == 0x06C45D188009454Fu);
}

TEST_CASE("hashes keep their values from release to release", "[hash]") {
  static_assert(hash64(1, 2, 3) == hash64(1u, uint8_t{2}, 3L));
  CHECK(hash64() == 0);
  CHECK(hash64(1, 2.0f, 3.0) == 0xb12bc0e3642105fc);
  CHECK(Hash64(7).add(std::vector<float>{1, 2, 3}).value() == 0x752b8cf9a431c6ec);
}

TEST_CASE("order, length and sign of zero count", "[hash]") {
  CHECK(hash64(1, 2) != hash64(2, 1));
  CHECK(hash64(0) != hash64(0, 0));
  CHECK(hash64(0.0f) != hash64(-0.0f));
  const std::vector<int> one = {1}, two = {2}, both = {1, 2}, none;
  CHECK(hash64(one, two) != hash64(both, none));
}

TEST_CASE("one changed input bit changes about half of the hash", "[hash]") {
  constexpr uint64_t keys = 2000;
  for (unsigned bit = 0; bit < 64; ++bit) {
    uint64_t changed = 0;
    for (uint64_t key = 0; key < keys; ++key) {
      changed += static_cast<unsigned>(std::popcount(hash64(key) ^ hash64(key ^ (uint64_t{1} << bit))));
    }
    // Each of the 64 keys * 2000 bits flips with probability 1/2: six standard deviations.
    const double flips = 64.0 * keys;
    CHECK(std::abs(static_cast<double>(changed) - flips / 2) < 6 * std::sqrt(flips / 4));
  }
}

TEST_CASE("small keys collide nowhere and give uniform floats below one", "[hash]") {
  std::set<uint64_t> seen;
  constexpr unsigned side = 200;
  unsigned cells[16] = {};
  for (unsigned x = 0; x < side; ++x) {
    for (unsigned y = 0; y < side; ++y) {
      const uint64_t hash = hash64(x, y);
      seen.insert(hash);
      const float u = unit_float(hash);
      REQUIRE((u >= 0 && u < 1));
      ++cells[static_cast<unsigned>(u * 16)];
    }
  }
  CHECK(seen.size() == side * side);
  for (const unsigned cell : cells) CHECK(std::abs(cell - 2500.0) < 6 * std::sqrt(2500.0));
  CHECK(unit_float(UINT64_MAX) < 1.0f);
}
