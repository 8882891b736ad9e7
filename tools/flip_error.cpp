#include <rayloom/tools/flip_error.h>

#include <rayloom/base/det_math.h>
#include <rayloom/base/parallel.h>
#include <rayloom/tools/flip_color.h>
#include <rayloom/tools/flip_contrast.h>
#include <rayloom/tools/flip_features.h>

#include <algorithm>

namespace rayloom::tools::flip {
namespace {

constexpr uint64_t pixels_per_chunk = 4096;

/// Distances of colours are raised to this power: large ones differ less than their numbers say.
constexpr float color_exponent = 0.7f;
/// Errors below this part of the largest one take up this part of the range.
constexpr float knee = 0.4f, knee_value = 0.95f;

/// Calls f(i) for every pixel, from several threads.
template <class Function>
void for_each_pixel(const Plane& plane, Function&& f) {
  parallel_for(plane.values.size(), pixels_per_chunk, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) f(i);
  });
}

template <class Function>
Planes map_colors(const Planes& in, Function&& f) {
  const Plane empty(in[0].width, in[0].height);
  Planes out{empty, empty, empty};
  for_each_pixel(empty, [&](uint64_t i) {
    const Color color = f(Color{in[0].values[i], in[1].values[i], in[2].values[i]});
    for (size_t c = 0; c < 3; ++c) out[c].values[i] = color[c];
  });
  return out;
}

Color clamp_unit(Color color) {
  for (float& value : color) value = std::clamp(value, 0.0f, 1.0f);
  return color;
}

/// What both branches of the metric need of one picture.
struct Seen {
  Planes lab;         ///< filtered as the eye does, Hunt-adjusted L*a*b*
  Features features;  ///< of the unfiltered picture
};

Seen see(const Planes& rgb, double pixels_per_degree) {
  const Planes ycxcz = map_colors(rgb, to_ycxcz);
  Plane grey = ycxcz[0];
  for (float& value : grey.values) value = (value + 16) / 116;
  return {map_colors(filter_contrast(ycxcz, pixels_per_degree),
                     [](const Color& filtered) { return to_hunt_lab(clamp_unit(from_ycxcz(filtered))); }),
          detect_features(grey, pixels_per_degree)};
}

/// The distance of green and blue, the largest of all.
float largest_color_error() { return det::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), color_exponent); }

/// Spreads the error over [0,1]: most of the range for the smaller errors, which are the common ones.
float redistribute(float error, float largest) {
  const float bend = knee * largest;
  if (error < bend) return knee_value / bend * error;
  return std::min(knee_value + (error - bend) / (largest - bend) * (1 - knee_value), 1.0f);
}

float color_error(const Planes& x, const Planes& y, uint64_t i, float largest) {
  const auto color = [i](const Planes& p) { return Color{p[0].values[i], p[1].values[i], p[2].values[i]}; };
  return redistribute(det::pow(hyab(color(x), color(y)), color_exponent), largest);
}

}  // namespace

Plane error_map(const Planes& picture, const Planes& reference, double pixels_per_degree) {
  const Seen x = see(picture, pixels_per_degree), r = see(reference, pixels_per_degree);
  const float largest = largest_color_error();
  Plane map = feature_difference(x.features, r.features);
  for_each_pixel(
      map, [&](uint64_t i) { map.values[i] = det::pow(color_error(x.lab, r.lab, i, largest), 1 - map.values[i]); });
  return map;
}

}  // namespace rayloom::tools::flip
