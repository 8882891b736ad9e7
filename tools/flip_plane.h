#pragma once

// Planes of floats and separable convolution with them.

#include <array>
#include <cstdint>
#include <vector>

namespace rayloom::tools::flip {

/// One value a pixel, row by row from the top left.
struct Plane {
  uint32_t width = 0, height = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(uint32_t w, uint32_t h) : width(w), height(h), values(uint64_t{w} * h) {}
  const float* row(uint32_t y) const { return values.data() + uint64_t{y} * width; }
  float* row(uint32_t y) { return values.data() + uint64_t{y} * width; }
};

/// Three planes of one size: R, G, B or another colour space.
using Planes = std::array<Plane, 3>;

/// Weights of an odd number of neighbours, the middle one at the pixel itself.
using Kernel = std::vector<float>;

/// Weighted sums of horizontal or vertical neighbours: out(i) = sum over k of kernel[k] in(i + k - radius). Beyond the
/// edge the nearest pixel stands in. The sum runs in the order of k, so the bits depend on nothing else.
Plane convolve_rows(const Plane& in, const Kernel& kernel);
Plane convolve_columns(const Plane& in, const Kernel& kernel);

/// A kernel of 2 radius + 1 weights f(-radius), ..., f(radius), as given.
template <class Function>
std::vector<double> sample_kernel(int radius, Function&& f) {
  std::vector<double> weights;
  for (int i = -radius; i <= radius; ++i) weights.push_back(f(static_cast<double>(i)));
  return weights;
}

/// Scales weights so that the positive ones add up to 1 and the negative ones to -1.
Kernel normalize(const std::vector<double>& weights);

}  // namespace rayloom::tools::flip
