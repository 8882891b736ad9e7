#include <rayloom/shaders/dielectric_albedo.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

namespace {

/// Directional albedo by quadrature over half vectors: tan(theta_h) = alpha sqrt(x / (1 - x)) makes D cos(theta_h)
/// uniform in x, and x = 1 - y^2 removes the 1 / cos(theta_h) of the far end.
double albedo(double roughness, double cosine) {
  const double alpha = std::max(roughness * roughness, 1e-3);
  const auto lambda = [&](double z) { return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - z * z) / (z * z)) - 1); };
  const double ox = std::sqrt(1 - cosine * cosine), oz = cosine;
  constexpr int n = 500;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double y = (i + 0.5) / n, x = 1 - y * y, hz = 1 / std::sqrt(1 + alpha * alpha * x / (1 - x));
      const double o_dot_h = ox * std::sqrt(1 - hz * hz) * std::cos(M_PI * (j + 0.5) / n) + oz * hz;
      const double iz = 2 * o_dot_h * hz - oz;
      if (o_dot_h <= 0 || iz <= 0) continue;
      const double fresnel = 0.04 + 0.96 * std::pow(1 - o_dot_h, 5);
      sum += 2 * y * fresnel * o_dot_h / (oz * hz) / (1 + lambda(oz) + lambda(iz));
    }
  return sum / (double(n) * n);
}

}  // namespace

TEST_CASE("the dielectric albedo table is what the quadrature gives, on and off its points") {
  for (const float roughness : {0.0f, 0.1f, 0.2f, 0.37f, 0.5f, 0.8f, 1.0f}) {
    for (const float cosine : {0.12f, 0.3f, 0.5f, 0.77f, 1.0f}) {
      CAPTURE(roughness, cosine);
      CHECK(rayloom::shaders::dielectric_albedo(roughness, cosine) == Approx(albedo(roughness, cosine)).margin(0.02));
    }
    for (const float cosine : {0.01f, 0.05f}) {
      CAPTURE(roughness, cosine);
      CHECK(rayloom::shaders::dielectric_albedo(roughness, cosine) == Approx(albedo(roughness, cosine)).margin(0.1));
    }
  }
}
