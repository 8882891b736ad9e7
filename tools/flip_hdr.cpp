#include <rayloom/tools/flip_hdr.h>

#include <rayloom/base/det_math.h>
#include <rayloom/tools/flip_color.h>
#include <rayloom/tools/flip_error.h>

#include <algorithm>
#include <cmath>

namespace rayloom::tools::flip {
namespace {

/// (n2 x^2 + n1 x) / (d2 x^2 + d1 x + d0)
constexpr double exposure_factor = 0.6;
constexpr double n2 = exposure_factor * exposure_factor * 2.51, n1 = exposure_factor * 0.03;
constexpr double d2 = exposure_factor * exposure_factor * 2.43, d1 = exposure_factor * 0.59, d0 = 0.14;

/// Where the curve reaches `value`: the positive root of the quadratic equation.
double invert_aces(double value) {
  const double a = n2 - value * d2, b = n1 - value * d1, c = -value * d0;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

std::vector<float> finite_luminances(const Planes& rgb) {
  std::vector<float> values;
  for (size_t i = 0; i < rgb[0].values.size(); ++i) {
    const float value = luminance({rgb[0].values[i], rgb[1].values[i], rgb[2].values[i]});
    if (std::isfinite(value)) values.push_back(value);
  }
  return values;
}

/// The middle one of sorted values, or the mean of the two in the middle.
double median(const std::vector<float>& sorted) {
  const size_t half = sorted.size() / 2;
  const double upper = static_cast<double>(sorted[half]);
  return sorted.size() % 2 ? upper : (static_cast<double>(sorted[half - 1]) + upper) / 2;
}

Plane expose(const Plane& in, float scale) {
  Plane out = in;
  for (float& value : out.values) value = tone_map_aces(value * scale);
  return out;
}

Planes expose(const Planes& rgb, double stops) {
  const auto scale = static_cast<float>(det::exp2(stops));
  return {expose(rgb[0], scale), expose(rgb[1], scale), expose(rgb[2], scale)};
}

}  // namespace

Exposures choose_exposures(const Planes& reference) {
  std::vector<float> sorted = finite_luminances(reference);
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty() || !(sorted.back() > 0)) return {};
  const double brightest = static_cast<double>(sorted.back());
  const double middle = std::max(median(sorted), brightest * 0x1p-16);
  const double goal = invert_aces(0.85);
  Exposures exposures{det::log2(goal / brightest), det::log2(goal / middle), 2};
  exposures.count = std::max(2u, static_cast<uint32_t>(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

float tone_map_aces(float linear) {
  const double x = std::min(static_cast<double>(linear), 1e6);
  return static_cast<float>(std::min((n2 * x + n1) * x / ((d2 * x + d1) * x + d0), 1.0));
}

Plane hdr_error_map(const Planes& picture, const Planes& reference, double pixels_per_degree,
                    const Exposures& exposures) {
  Plane worst(reference[0].width, reference[0].height);
  for (uint32_t e = 0; e < exposures.count; ++e) {
    const double stops = exposures.at(e);
    const Plane map = error_map(expose(picture, stops), expose(reference, stops), pixels_per_degree);
    for (size_t i = 0; i < map.values.size(); ++i) worst.values[i] = std::max(worst.values[i], map.values[i]);
  }
  return worst;
}

}  // namespace rayloom::tools::flip
