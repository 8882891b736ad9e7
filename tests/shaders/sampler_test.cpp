#include <rayloom/shaders/sampler.h>

#include "statistics.h"

#include <catch2/catch.hpp>

#include <array>
#include <set>
#include <vector>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

/// Whether 2^k points have exactly one in every elementary interval of base 2 and volume 2^-k.
bool is_net(const std::vector<std::array<uint32_t, 2>>& points, int k) {
  for (int bits_x = 0; bits_x <= k; ++bits_x) {
    std::vector<int> count(points.size());
    for (const auto& [x, y] : points) {
      const uint64_t column = uint64_t{x} >> (32 - bits_x), row = uint64_t{y} >> (32 - (k - bits_x));
      ++count[(column << (k - bits_x)) | row];
    }
    for (const int c : count)
      if (c != 1) return false;
  }
  return true;
}

uint32_t fraction(float x) { return static_cast<uint32_t>(x * 0x1p32f); }

template <typename Draw>
bool sampler_makes_nets(uint2 pixel, uint32_t seed, uint32_t first, int k, Draw draw) {
  std::vector<std::array<uint32_t, 2>> points;
  for (uint32_t i = 0; i < (1u << k); ++i) {
    Sampler sampler(pixel, first + i, seed);
    const float2 p = draw(sampler);
    points.push_back({fraction(p.x), fraction(p.y)});
  }
  return is_net(points, k);
}

}  // namespace

TEST_CASE("the first sixteen points are Sobol's with the numbers of Joe and Kuo") {
  // In sixteenths, from an independent evaluation of the recurrence in index order.
  constexpr std::array<std::array<uint32_t, 16>, 4> expected{{{0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15},
                                                              {0, 8, 12, 4, 10, 2, 6, 14, 15, 7, 3, 11, 5, 13, 9, 1},
                                                              {0, 8, 12, 4, 6, 14, 10, 2, 9, 1, 5, 13, 15, 7, 3, 11},
                                                              {0, 8, 12, 4, 2, 10, 14, 6, 5, 13, 9, 1, 7, 15, 11, 3}}};
  for (uint32_t i = 0; i < 16; ++i) {
    CHECK(sobol_0(i) >> 28 == expected[0][i]);
    CHECK(sobol_1(i) >> 28 == expected[1][i]);
    CHECK(sobol_2(i) >> 28 == expected[2][i]);
    CHECK(sobol_3(i) >> 28 == expected[3][i]);
  }
}

TEST_CASE("unscrambled dimensions 0 and 1 are a (0,2)-sequence") {
  for (int k = 0; k <= 10; ++k)
    for (uint32_t block = 0; block < 5; ++block) {
      std::vector<std::array<uint32_t, 2>> points;
      for (uint32_t i = block << k; i < (block + 1) << k; ++i) points.push_back({sobol_0(i), sobol_1(i)});
      REQUIRE(is_net(points, k));
    }
}

TEST_CASE("every aligned run of 2^k samples is a (0,k,2)-net after scrambling") {
  for (uint32_t seed = 0; seed < 4; ++seed)
    for (uint2 pixel : {uint2(0, 0), uint2(7, 3), uint2(1919, 1079)})
      for (int k = 0; k <= 10; ++k)
        for (uint32_t block : {0u, 1u, 6u}) {
          REQUIRE(sampler_makes_nets(pixel, seed, block << k, k, [](Sampler& s) { return s.next_2d(); }));
          REQUIRE(sampler_makes_nets(pixel, seed, block << k, k, [](Sampler& s) {
            s.next_4d(), s.next_2d();
            return float2(s.next_4d());
          }));
        }
}

TEST_CASE("every coordinate of a 4D draw is stratified alone") {
  constexpr int k = 9;
  for (int axis = 0; axis < 4; ++axis) {
    std::set<uint32_t> strata;
    for (uint32_t i = 0; i < (1u << k); ++i) strata.insert(fraction(Sampler({5, 9}, i, 1).next_4d()[axis]) >> (32 - k));
    CHECK(strata.size() == 1u << k);
  }
}

TEST_CASE("one sample is uniform over pixels and seeds, and independent of the next draw") {
  constexpr int cells = 16, draws = 200000;
  std::vector<double> single(cells * cells), across(cells * cells);
  const std::vector<double> expected(cells * cells, double(draws) / (cells * cells));
  const auto cell = [](float x, float y) {
    return static_cast<size_t>(x * cells) * cells + static_cast<size_t>(y * cells);
  };
  for (uint32_t i = 0; i < draws; ++i) {
    Sampler sampler(uint2(i % 512, i / 512), 3, 17);
    const float4 a = sampler.next_4d();
    const float2 b = sampler.next_2d();
    ++single[cell(a.x, a.y)], ++across[cell(a.z, b.x)];
  }
  CHECK(test::chi_square_p_value(single, expected) > test::sidak(0.01, 2));
  CHECK(test::chi_square_p_value(across, expected) > test::sidak(0.01, 2));
}

TEST_CASE("Owen scrambling integrates a smooth function with an error far below a random one's") {
  // Owen 1997: the standard deviation falls as n^-3/2; independent samples give n^-1/2 (0.28 / 16 at n = 256).
  const auto deviation = [](uint32_t n) {
    test::Moments means;
    for (uint32_t seed = 0; seed < 200; ++seed) {
      double sum = 0;
      for (uint32_t i = 0; i < n; ++i) {
        const float2 p = Sampler({0, 0}, i, seed).next_2d();
        sum += double(p.x) * p.y;
      }
      means.add(sum / n);
    }
    CHECK(std::abs(means.mean - 0.25) < 4 * means.standard_error());
    return std::sqrt(means.variance());
  };
  const double coarse = deviation(64), fine = deviation(1024);
  CHECK(fine < 0.22 / 32 / 20);
  CHECK(coarse / fine > std::pow(16, 1.35));
}

TEST_CASE("samples depend on pixel, sample, draw and seed, and on nothing else") {
  const auto first = [](uint2 pixel, uint32_t sample, uint32_t seed) {
    Sampler s(pixel, sample, seed);
    return s.next_2d();
  };
  CHECK(first({3, 4}, 5, 6) == first({3, 4}, 5, 6));
  CHECK(first({3, 4}, 5, 6) != first({4, 3}, 5, 6));
  CHECK(first({3, 4}, 5, 6) != first({3, 4}, 6, 6));
  CHECK(first({3, 4}, 5, 6) != first({3, 4}, 5, 7));
  Sampler s({3, 4}, 5, 6);
  CHECK(s.next_2d() != s.next_2d());
}

TEST_CASE("samples are in [0, 1)") {
  CHECK(unit_float(0xffffffffu) < 1.0f);
  CHECK(unit_float(0u) == 0.0f);
  CHECK(unit_float(0x80000000u) == 0.5f);
}

TEST_CASE("candidate random numbers name the candidate") {
  const CandidateKey key{Sampler({1, 2}, 3, 4).path_key(), 5, 6, 7};
  const float value = candidate_random(key);
  CHECK(value == candidate_random(key));
  CHECK(value != candidate_random({key.path, 6, 5, 7}));
  CHECK(value != candidate_random({key.path, 5, 6, 8}));
  CHECK(value != candidate_random({Sampler({1, 2}, 4, 4).path_key(), 5, 6, 7}));
  std::vector<double> count(64), expected(64, 1000);
  for (uint32_t i = 0; i < 64000; ++i)
    ++count[static_cast<size_t>(64 * candidate_random({key.path, 0, i >> 8, i & 255}))];
  CHECK(test::chi_square_p_value(count, expected) > 0.01);
}
