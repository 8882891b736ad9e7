#pragma once

#include <cmath>

namespace rayloom::test {

/// Directional albedo of a white-Fresnel GGX reflection in double precision, integrated over half vectors: an estimate
/// that shares no formula with the sampler. Substituting tan(theta_h) = alpha sqrt(x / (1 - x)) flattens the peak, and
/// x = 1 - y^2 the 1 / cos(theta_h) of the far end.
inline double ggx_albedo(double alpha, double cosine) {
  const auto lambda = [&](double z) { return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - z * z) / (z * z)) - 1); };
  const double ox = std::sqrt(1 - cosine * cosine), oz = cosine;
  constexpr int nx = 1200, np = 600;
  double sum = 0;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < np; ++j) {
      const double y = (i + 0.5) / nx, x = 1 - y * y, phi = M_PI * (j + 0.5) / np;
      const double tan2 = alpha * alpha * x / (1 - x), hz = 1 / std::sqrt(1 + tan2), hr = std::sqrt(1 - hz * hz);
      const double o_dot_h = ox * hr * std::cos(phi) + oz * hz, iz = 2 * o_dot_h * hz - oz;
      if (o_dot_h <= 0 || iz <= 0) continue;
      // D cos(theta_h) dh integrates to one over (x, phi): weight F G2 (o.h) / (cos_o cos_h).
      sum += 2 * y * o_dot_h / (oz * hz) / (1 + lambda(oz) + lambda(iz));
    }
  return sum / (double(nx) * np);
}

}  // namespace rayloom::test
