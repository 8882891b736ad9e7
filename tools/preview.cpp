#include <rayloom/tools/preview.h>

#include <rayloom/base/det_math.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rayloom::tools {
namespace {

using Rgb = std::array<float, 3>;

const std::vector<float>& floats_of(const Image& image, const char* name) {
  const Channel* channel = image.find(name);
  if (!channel || channel->is_id()) throw std::logic_error(std::string("a preview needs channel ") + name);
  return channel->floats();
}

void append(Preview& preview, const Rgb& linear) {
  for (const float value : linear) preview.rgb.push_back(encode_srgb(value));
}

/// Stops of the heat map, in sRGB so that equal steps of the value look about equal.
constexpr std::array<Rgb, 6> heat_stops{
    {{0, 0, 0}, {0.13f, 0.09f, 0.60f}, {0.60f, 0.10f, 0.65f}, {0.95f, 0.40f, 0.25f}, {0.99f, 0.80f, 0.25f}, {1, 1, 1}}};

Rgb heat_color(float value, float top) {
  if (std::isnan(value)) return {0, 1, 0};
  const float unit = value <= 0 ? 0 : value >= top ? 1 : value / top;
  const float position = unit * static_cast<float>(heat_stops.size() - 1);
  const size_t low = std::min(static_cast<size_t>(position), heat_stops.size() - 2);
  const float weight = position - static_cast<float>(low);
  Rgb color;
  for (size_t i = 0; i < 3; ++i) color[i] = heat_stops[low][i] * (1 - weight) + heat_stops[low + 1][i] * weight;
  return color;
}

}  // namespace

std::array<float, 3> tone_map_neutral(Rgb color) {
  constexpr float start = 0.8f - 0.04f, desaturation = 0.15f;
  for (float& value : color) value = std::max(value, 0.0f);
  const float darkest = *std::min_element(color.begin(), color.end());
  const float offset = darkest < 0.08f ? darkest - 6.25f * darkest * darkest : 0.04f;
  for (float& value : color) value -= offset;
  const float peak = *std::max_element(color.begin(), color.end());
  if (!(peak >= start)) return color;
  if (std::isinf(peak)) return {1, 1, 1};
  constexpr float room = 1 - start;
  const float new_peak = 1 - room * room / (peak + room - start);
  const float white = 1 - 1 / (desaturation * (peak - new_peak) + 1);
  for (float& value : color) value = value * (new_peak / peak) * (1 - white) + new_peak * white;
  return color;
}

uint8_t encode_srgb(float linear) {
  const float x = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
  const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * det::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<uint8_t>(encoded * 255 + 0.5f);
}

Preview make_preview(const Image& image, ToneMap tone_map, float exposure_stops) {
  const auto& r = floats_of(image, "R");
  const auto& g = floats_of(image, "G");
  const auto& b = floats_of(image, "B");
  const float scale = det::exp2(exposure_stops);
  Preview preview{image.width, image.height, {}};
  preview.rgb.reserve(3 * r.size());
  for (size_t i = 0; i < r.size(); ++i) {
    const Rgb color{r[i] * scale, g[i] * scale, b[i] * scale};
    append(preview, tone_map == ToneMap::neutral ? tone_map_neutral(color) : color);
  }
  return preview;
}

Preview make_heat_map(uint32_t width, uint32_t height, std::span<const float> values, float top) {
  Preview preview{width, height, {}};
  preview.rgb.reserve(3 * values.size());
  for (const float value : values) {
    for (const float part : heat_color(value, top)) preview.rgb.push_back(static_cast<uint8_t>(part * 255 + 0.5f));
  }
  return preview;
}

float quantile(std::span<const float> values, double fraction) {
  std::vector<float> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](float v) { return std::isfinite(v); });
  if (finite.empty()) return 0;
  const auto rank = static_cast<size_t>(std::ceil(fraction * static_cast<double>(finite.size())));
  const size_t index = std::min(std::max<size_t>(rank, 1), finite.size()) - 1;
  std::nth_element(finite.begin(), finite.begin() + static_cast<std::ptrdiff_t>(index), finite.end());
  return finite[index];
}

}  // namespace rayloom::tools
