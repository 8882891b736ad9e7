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

TEST_CASE(
    "the first two dimensions of every draw are a net, however many draws came before, of two and four dimensions") {
  constexpr int k = 8;
  for (uint32_t before = 0; before < 24; ++before) {
    const auto after_others = [&](Sampler& s) {
      for (uint32_t i = 0; i < before; ++i) i % 3 ? static_cast<void>(s.next_4d()) : static_cast<void>(s.next_2d());
      return before % 2 ? float2(s.next_4d()) : s.next_2d();
    };
    REQUIRE(sampler_makes_nets({31, 8}, 2, 3u << k, k, after_others));
  }
}

TEST_CASE("independent numbers make no net") {
  std::vector<std::array<uint32_t, 2>> points;
  for (uint32_t i = 0; i < 64; ++i) {
    const float2 p = Sampler({31, 8}, i, 2, SamplerKind::independent).next_2d();
    points.push_back({fraction(p.x), fraction(p.y)});
  }
  CHECK_FALSE(is_net(points, 6));
}

TEST_CASE("every coordinate of a 4D draw is stratified alone") {
  constexpr int k = 9;
  for (int axis = 0; axis < 4; ++axis) {
    std::set<uint32_t> strata;
    for (uint32_t i = 0; i < (1u << k); ++i) strata.insert(fraction(Sampler({5, 9}, i, 1).next_4d()[axis]) >> (32 - k));
    CHECK(strata.size() == 1u << k);
  }
}

TEST_CASE("every coordinate of either sampler is uniform over pixels, over samples and over seeds (chi-square)") {
  constexpr int cells = 64, draws = 32768, tests = 2 * 3 * 2 * 4;
  const std::vector<double> expected(cells, double(draws) / cells);
  for (const SamplerKind kind : {SamplerKind::owen_sobol, SamplerKind::independent})
    for (int over = 0; over < 3; ++over)
      for (int draw = 0; draw < 2; ++draw) {
        std::array<std::vector<double>, 4> count;
        count.fill(std::vector<double>(cells));
        for (uint32_t i = 0; i < draws; ++i) {
          Sampler sampler(uint2(over == 0 ? i : 12, 7), over == 1 ? i : 3, over == 2 ? i : 1, kind);
          for (int skipped = 0; skipped < draw; ++skipped) sampler.next_2d();
          const float4 u = sampler.next_4d();
          for (int axis = 0; axis < 4; ++axis) ++count[axis][static_cast<size_t>(u[axis] * cells)];
        }
        CAPTURE(static_cast<int>(kind), over, draw);
        for (const auto& axis : count) CHECK(test::chi_square_p_value(axis, expected) > test::sidak(0.001, tests));
      }
}

TEST_CASE("errors of neighbouring pixels, and of draws of one pixel, are not correlated") {
  // What a pixel's 16 samples make of x y in each of four draws, less the true 1/4. A correlation of n pairs that have
  // none is nearly normal with deviation 1 / sqrt(n).
  constexpr uint32_t side = 96, samples = 16;
  constexpr int draws = 4, tests = 2 * (2 + 6);
  const auto check = [](SamplerKind kind) {
    std::vector<std::array<double, draws>> errors(side * side);
    for (uint32_t p = 0; p < side * side; ++p)
      for (uint32_t i = 0; i < samples; ++i) {
        Sampler sampler({p % side, p / side}, i, 11, kind);
        for (int d = 0; d < draws; ++d) {
          const float4 u = sampler.next_4d();
          errors[p][d] += (double(u.x) * u.y - 0.25) / samples;
        }
      }
    const auto uncorrelated = [&](uint32_t offset, int a, int b) {
      double ab = 0, aa = 0, bb = 0;
      for (uint32_t p = 0; p + offset < side * side; ++p) {
        const double x = errors[p][a], y = errors[p + offset][b];
        ab += x * y, aa += x * x, bb += y * y;
      }
      const double deviations = std::abs(ab / std::sqrt(aa * bb)) * side;
      return std::erfc(deviations / std::sqrt(2.0)) > test::sidak(0.001, tests);
    };
    CHECK(uncorrelated(1, 0, 0));
    CHECK(uncorrelated(side, 0, 0));
    for (int a = 0; a < draws; ++a)
      for (int b = a + 1; b < draws; ++b) CHECK(uncorrelated(0, a, b));
    CHECK_FALSE(uncorrelated(0, 0, 0));  // the test can tell
  };
  check(SamplerKind::owen_sobol);
  check(SamplerKind::independent);
}

TEST_CASE("independent numbers integrate with the error of independent numbers") {
  // The variance of x y over the unit square is 1/9 - 1/16; that of a sample variance of n normals 2 v^2 / (n - 1).
  constexpr uint32_t n = 64, seeds = 2000;
  test::Moments means;
  for (uint32_t seed = 0; seed < seeds; ++seed) {
    double sum = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const float2 p = Sampler({0, 0}, i, seed, SamplerKind::independent).next_2d();
      sum += double(p.x) * p.y;
    }
    means.add(sum / n);
  }
  const double expected = (1.0 / 9 - 1.0 / 16) / n;
  CHECK(std::abs(means.mean - 0.25) < 4 * means.standard_error());
  CHECK(std::abs(means.variance() / expected - 1) < 4 * std::sqrt(2.0 / (seeds - 1)));
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
  Sampler independent({3, 4}, 5, 6, SamplerKind::independent);
  CHECK(first({3, 4}, 5, 6) != independent.next_2d());
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
