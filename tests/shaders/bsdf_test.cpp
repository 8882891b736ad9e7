#include <rayloom/shaders/bsdf.h>
#include <rayloom/shaders/sampler.h>

#include "ggx_quadrature.h"
#include "statistics.h"

#include <catch2/catch.hpp>

#include <array>
#include <vector>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

struct Case {
  float3 base_color;
  float metallic, roughness, specular;
};

const std::array<Case, 9> cases{{{{1, 1, 1}, 0, 1, 0},
                                 {{1, 1, 1}, 0, 0.3f, 1},
                                 {{1, 1, 1}, 0, 0.5f, 1},
                                 {{0.8f, 0.5f, 0.2f}, 0, 1, 1},
                                 {{0.8f, 0.5f, 0.2f}, 0, 0.4f, 1},
                                 {{1, 1, 1}, 1, 1, 1},
                                 {{1, 0.8f, 0.3f}, 1, 0.5f, 1},
                                 {{0.9f, 0.9f, 0.9f}, 1, 0.3f, 1},
                                 {{0.6f, 0.7f, 0.8f}, 0.5f, 0.6f, 1}}};
constexpr std::array<float, 5> cosines{1.0f, 0.9f, 0.5f, 0.2f, 0.05f};

float3 view(float cosine) {
  return {std::sqrt(1 - cosine * cosine) * 0.6f, -std::sqrt(1 - cosine * cosine) * 0.8f, cosine};
}

Bsdf make(const Case& c, float3 wo) {
  return with_specular_chance(metallic_roughness(c.base_color, c.metallic, c.roughness, c.specular), wo);
}

/// sample_bsdf with independent random numbers.
BsdfSample draw(const Bsdf& bsdf, float3 wo, uint32_t i, uint32_t stream) {
  const float4 u = Sampler({i, stream}, 0, 99).next_4d();
  return sample_bsdf(bsdf, wo, u.z, {u.x, u.y});
}

/// Heights of cells crowd towards the pole, where smooth surfaces reflect: z = 1 - s^3 for s in 0..1.
float cell_height(double s) { return static_cast<float>(1 - s * s * s); }

/// Sums of the pdf over cells of (s, turn), by the midpoint rule within each cell.
std::vector<double> integrate_pdf(const Bsdf& bsdf, float3 wo, int rows, int columns, int refine) {
  std::vector<double> cells(rows * columns);
  for (int i = 0; i < rows * refine; ++i)
    for (int j = 0; j < columns * refine; ++j) {
      const double s = (i + 0.5) / (rows * refine);
      const float3 wi = direction_at(cell_height(s), (float(j) + 0.5f) / float(columns * refine));
      cells[(i / refine) * columns + j / refine] += evaluate_bsdf(bsdf, wo, wi).pdf * 3 * s * s;
    }
  for (double& c : cells) c *= 2 * M_PI / (double(rows) * columns * refine * refine);
  return cells;
}

}  // namespace

TEST_CASE("sampled directions follow the stated pdf (chi-square, Sidak)") {
  constexpr int rows = 20, columns = 40, draws = 200000, tests = int(cases.size() * cosines.size());
  uint32_t stream = 0;
  for (const Case& c : cases)
    for (const float cosine : cosines) {
      const float3 wo = view(cosine);
      const Bsdf bsdf = make(c, wo);
      std::vector<double> observed(rows * columns + 1), expected = integrate_pdf(bsdf, wo, rows, columns, 40);
      ++stream;
      for (uint32_t i = 0; i < draws; ++i) {
        const BsdfSample sample = draw(bsdf, wo, i, stream);
        if (sample.pdf == 0) {
          ++observed.back();
          continue;
        }
        double turn = std::atan2(sample.wi.y, sample.wi.x) / (2 * M_PI);
        if (turn < 0) turn += 1;
        const int row = std::min(rows - 1, int(std::cbrt(1 - double(sample.wi.z)) * rows)),
                  column = std::min(columns - 1, int(turn * columns));
        ++observed[row * columns + column];
      }
      double inside = 0;
      for (double& e : expected) inside += e, e *= draws;
      expected.push_back(std::max(0.0, 1 - inside) * draws);
      CAPTURE(c.metallic, c.roughness, cosine, inside);
      CHECK(inside < 1.002);
      if (expected.back() < 5) expected.back() = observed.back();
      CHECK(test::chi_square_p_value(observed, expected) > test::sidak(0.01, tests));
    }
}

TEST_CASE("the visible normal distribution integrates to one over the hemisphere") {
  for (const float alpha : {0.1f, 0.3f, 1.0f})
    for (const float cosine : cosines) {
      const float3 wo = view(cosine);
      constexpr int n = 1500;
      double sum = 0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          sum += ggx_visible_normal_pdf(wo, direction_at((float(i) + 0.5f) / n, (float(j) + 0.5f) / n), alpha);
      CHECK(sum * 2 * M_PI / (double(n) * n) == Approx(1).epsilon(2e-3));
    }
}

TEST_CASE("reflection is reciprocal") {
  for (const Case& c : cases)
    for (uint32_t i = 0; i < 1000; ++i) {
      const float4 u = Sampler({i, 1}, 0, 5).next_4d();
      const float3 a = cosine_hemisphere({u.x, u.y}), b = cosine_hemisphere({u.z, u.w});
      const Bsdf bsdf = metallic_roughness(c.base_color, c.metallic, c.roughness, c.specular);
      const float3 forward = evaluate_bsdf(bsdf, a, b).reflected / b.z,
                   back = evaluate_bsdf(bsdf, b, a).reflected / a.z;
      for (int k = 0; k < 3; ++k) REQUIRE(forward[k] == Approx(back[k]).epsilon(1e-4));
    }
}

TEST_CASE("a sample's weight is value over pdf, and both are what evaluate_bsdf gives") {
  for (const Case& c : cases)
    for (uint32_t i = 0; i < 1000; ++i) {
      const float3 wo = view(cosines[i % cosines.size()]);
      const Bsdf bsdf = make(c, wo);
      const BsdfSample sample = draw(bsdf, wo, i, 77);
      const BsdfValue value = evaluate_bsdf(bsdf, wo, sample.wi);
      REQUIRE(sample.pdf == value.pdf);
      if (sample.pdf > 0) REQUIRE(sample.weight == value.reflected / value.pdf);
      REQUIRE(std::abs(glm::length(sample.wi) - 1) < 1e-5f);
    }
}

TEST_CASE("no surface reflects more than it receives") {
  for (const Case& c : cases)
    for (const float cosine : cosines) {
      const float3 wo = view(cosine);
      const Bsdf bsdf = make(c, wo);
      test::Moments albedo;
      for (uint32_t i = 0; i < 100000; ++i) albedo.add(largest_component(draw(bsdf, wo, i, 3).weight));
      CAPTURE(c.metallic, c.roughness, cosine, albedo.mean);
      CHECK(albedo.mean < 1 + 4 * albedo.standard_error() + 2e-3);  // the albedo table's interpolation
    }
}

TEST_CASE("a smooth white dielectric gains less than 2 % at grazing angles") {
  for (const float cosine : {0.3f, 0.1f, 0.05f, 0.02f, 0.01f}) {
    const float3 wo = view(cosine);
    const Bsdf bsdf = make({{1, 1, 1}, 0, 0.1f, 1}, wo);
    test::Moments albedo;
    for (uint32_t i = 0; i < 100000; ++i) albedo.add(draw(bsdf, wo, i, 8).weight.x);
    CHECK(albedo.mean < 1.02 + 4 * albedo.standard_error());
  }
}

TEST_CASE("white furnace: white Lambert reflects exactly what arrives") {
  for (const float cosine : cosines) {
    const float3 wo = view(cosine);
    const Bsdf bsdf = make(cases[0], wo);
    for (uint32_t i = 0; i < 10000; ++i) {
      const BsdfSample sample = draw(bsdf, wo, i, 4);
      for (int k = 0; k < 3; ++k) REQUIRE(sample.weight[k] == Approx(1).margin(2e-7));
    }
  }
}

TEST_CASE("white furnace: GGX reflects its independently integrated directional albedo") {
  // 400,000 samples a case, 4 standard errors.
  for (const float roughness : {0.2f, 0.5f, 0.8f, 1.0f})
    for (const float cosine : cosines) {
      const float3 wo = view(cosine);
      const Bsdf bsdf = make({{1, 1, 1}, 1, roughness, 1}, wo);
      test::Moments albedo;
      for (uint32_t i = 0; i < 400000; ++i) albedo.add(draw(bsdf, wo, i, 5).weight.x);
      const double expected = test::ggx_albedo(bsdf.alpha, cosine);
      CAPTURE(roughness, cosine, albedo.mean, expected, albedo.standard_error());
      CHECK(std::abs(albedo.mean - expected) < 4 * albedo.standard_error() + 1e-6);
    }
}

TEST_CASE("mirrors and grazing directions stay finite") {
  for (const float roughness : {0.0f, 0.01f, 1.0f})
    for (const float cosine : {1.0f, 1e-3f, 1e-7f, 1e-20f, 1e-38f})
      for (uint32_t i = 0; i < 2000; ++i) {
        const float3 wo = view(cosine);
        const Bsdf bsdf = make({{1, 1, 1}, 0.5f, roughness, 1}, wo);
        const BsdfSample sample = draw(bsdf, wo, i, 6);
        for (int k = 0; k < 3; ++k) {
          REQUIRE(std::isfinite(sample.weight[k]));
          REQUIRE(sample.weight[k] >= 0);
        }
        REQUIRE(std::isfinite(sample.pdf));
      }
}
