#include <rayloom/tools/flip.h>

#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>
#include <rayloom/tools/flip_color.h>
#include <rayloom/tools/flip_error.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rayloom::tools {
namespace {

constexpr const char* channel_names[] = {"R", "G", "B"};
constexpr uint64_t pixels_per_chunk = 4096;

const std::vector<float>& samples(const Image& image, const std::string& name, const char* channel_name) {
  const Channel* channel = image.find(channel_name);
  if (channel && !channel->is_id()) return channel->floats();
  throw InputError(name, std::string("channel ") + channel_name, "is missing: FLIP compares colours, R, G and B");
}

/// decode_srgb, looked up for the values that 8 bits can say.
float decode(float value) {
  using Table = std::array<std::array<float, 2>, 256>;
  static const Table table = [] {
    Table entries;
    for (size_t i = 0; i < entries.size(); ++i) {
      const float encoded = static_cast<float>(i) * (1 / 255.0f);
      entries[i] = {encoded, flip::decode_srgb(encoded)};
    }
    return entries;
  }();
  const auto index = static_cast<size_t>(std::min(value, 1.0f) * 255 + 0.5f);
  return table[index][0] == value ? table[index][1] : flip::decode_srgb(value);
}

/// Linear and at least 0; at most 1 in ldr mode.
float to_linear(float value, bool encoded, FlipMode mode) {
  if (!(value > 0)) return 0;
  const float linear = encoded ? decode(value) : value;
  return mode == FlipMode::ldr ? std::min(linear, 1.0f) : linear;
}

flip::Plane linear_plane(const Image& image, const std::vector<float>& values, FlipMode mode) {
  flip::Plane plane(image.width, image.height);
  parallel_for(values.size(), pixels_per_chunk, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) plane.values[i] = to_linear(values[i], image.is_encoded, mode);
  });
  return plane;
}

flip::Planes linear_planes(const Image& image, const std::string& name, FlipMode mode) {
  const auto plane = [&](const char* channel) { return linear_plane(image, samples(image, name, channel), mode); };
  return {plane("R"), plane("G"), plane("B")};
}

bool is_comparable(float x, float r) {
  return x == r || (std::isfinite(x) && std::isfinite(r)) || (std::isnan(x) && std::isnan(r));
}

void mark_incomparable(FlipResult& result, const Image& image, const Image& reference) {
  for (size_t i = 0; i < result.map.values.size(); ++i) {
    bool comparable = true;
    for (const char* name : channel_names) {
      comparable &= is_comparable(image.find(name)->floats()[i], reference.find(name)->floats()[i]);
    }
    if (comparable) continue;
    result.map.values[i] = 1;
    ++result.incomparable_pixels;
  }
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

FlipMode default_mode(const Image& image, const Image& reference) {
  return image.is_encoded || reference.is_encoded ? FlipMode::ldr : FlipMode::hdr;
}

}  // namespace

std::optional<FlipMode> find_flip_mode(std::string_view name) {
  for (size_t i = 0; i < std::size(flip_mode_names); ++i) {
    if (name == flip_mode_names[i]) return static_cast<FlipMode>(i);
  }
  return std::nullopt;
}

FlipResult compute_flip(const Image& image, const std::string& image_name, const Image& reference,
                        const std::string& reference_name, const FlipOptions& options) {
  FlipResult result;
  result.mode = options.mode.value_or(default_mode(image, reference));
  result.pixels_per_degree = options.pixels_per_degree;
  const flip::Planes x = linear_planes(image, image_name, result.mode);
  const flip::Planes r = linear_planes(reference, reference_name, result.mode);
  if (result.mode == FlipMode::hdr) {
    result.exposures = flip::choose_exposures(r);
    result.map = flip::hdr_error_map(x, r, options.pixels_per_degree, result.exposures);
  } else {
    result.map = flip::error_map(x, r, options.pixels_per_degree);
  }
  mark_incomparable(result, image, reference);
  result.mean = mean(result.map.values);
  return result;
}

Image flip_image(const FlipResult& result) {
  return {result.map.width, result.map.height, {{"FLIP", result.map.values}}, {}};
}

}  // namespace rayloom::tools
