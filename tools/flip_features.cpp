#include <rayloom/tools/flip_features.h>

#include <rayloom/base/det_math.h>

#include <algorithm>
#include <cmath>

namespace rayloom::tools::flip {
namespace {

/// Width of the eye's edge detector in degrees.
constexpr double detector_width = 0.082;

struct FeatureKernels {
  Kernel smooth, edge, point;
};

/// The 2D detectors are products of these: normalizing the factors normalizes them.
FeatureKernels make_kernels(double pixels_per_degree) {
  const double deviation = detector_width / 2 * pixels_per_degree, variance = deviation * deviation;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  const auto gauss = [&](double x) { return det::exp(-x * x / (2 * variance)); };
  return {normalize(sample_kernel(radius, gauss)),
          normalize(sample_kernel(radius, [&](double x) { return -x * gauss(x); })),
          normalize(sample_kernel(radius, [&](double x) { return (x * x / variance - 1) * gauss(x); }))};
}

/// Lengths of the vectors (x, y), into x.
Plane magnitude(Plane x, const Plane& y) {
  for (size_t i = 0; i < x.values.size(); ++i) {
    x.values[i] = std::sqrt(x.values[i] * x.values[i] + y.values[i] * y.values[i]);
  }
  return x;
}

}  // namespace

Features detect_features(const Plane& grey, double pixels_per_degree) {
  const auto [smooth, edge, point] = make_kernels(pixels_per_degree);
  const Plane smooth_rows = convolve_rows(grey, smooth);
  return {magnitude(convolve_columns(convolve_rows(grey, edge), smooth), convolve_columns(smooth_rows, edge)),
          magnitude(convolve_columns(convolve_rows(grey, point), smooth), convolve_columns(smooth_rows, point))};
}

Plane feature_difference(const Features& x, const Features& y) {
  Plane difference(x.edges.width, x.edges.height);
  for (size_t i = 0; i < difference.values.size(); ++i) {
    const float edges = std::abs(x.edges.values[i] - y.edges.values[i]);
    const float points = std::abs(x.points.values[i] - y.points.values[i]);
    constexpr float root_half = 0.70710678f;
    difference.values[i] = std::sqrt(std::min(root_half * std::max(edges, points), 1.0f));
  }
  return difference;
}

}  // namespace rayloom::tools::flip
