#include <rayloom/tools/flip_contrast.h>

#include <rayloom/base/det_math.h>

#include <cmath>
#include <numeric>

namespace rayloom::tools::flip {
namespace {

constexpr double pi = 3.14159265358979323846;

std::vector<double> sample(const Gaussian& gaussian, double pixels_per_degree) {
  return sample_kernel(contrast_radius(pixels_per_degree), [&](double pixels) {
    const double degrees = pixels / pixels_per_degree;
    return det::exp(-pi * pi * degrees * degrees / gaussian.b);
  });
}

Plane blur(const Plane& in, const Gaussian& gaussian, double pixels_per_degree) {
  const Kernel kernel = normalize(sample(gaussian, pixels_per_degree));
  return convolve_columns(convolve_rows(in, kernel), kernel);
}

/// The sum of a Gaussian's weights over the square of pixels.
double volume(const Gaussian& gaussian, double pixels_per_degree) {
  const std::vector<double> weights = sample(gaussian, pixels_per_degree);
  const double side = std::accumulate(weights.begin(), weights.end(), 0.0);
  return gaussian.a * std::sqrt(pi / gaussian.b) * side * side;
}

/// A sum of two Gaussians is not separable but each of them is: mix their blurs in proportion to their volumes.
Plane blur_twice(const Plane& in, const std::array<Gaussian, 2>& gaussians, double pixels_per_degree) {
  const double first = volume(gaussians[0], pixels_per_degree), second = volume(gaussians[1], pixels_per_degree);
  const auto weight = static_cast<float>(first / (first + second));
  Plane out = blur(in, gaussians[0], pixels_per_degree);
  const Plane other = blur(in, gaussians[1], pixels_per_degree);
  for (size_t i = 0; i < out.values.size(); ++i) {
    out.values[i] = weight * out.values[i] + (1 - weight) * other.values[i];
  }
  return out;
}

}  // namespace

int contrast_radius(double pixels_per_degree) {
  const double deviation = std::sqrt(blue_yellow_filter[0].b / (2 * pi * pi));
  return static_cast<int>(std::ceil(3 * deviation * pixels_per_degree));
}

Planes filter_contrast(const Planes& ycxcz, double pixels_per_degree) {
  return {blur(ycxcz[0], achromatic_filter, pixels_per_degree), blur(ycxcz[1], red_green_filter, pixels_per_degree),
          blur_twice(ycxcz[2], blue_yellow_filter, pixels_per_degree)};
}

}  // namespace rayloom::tools::flip
