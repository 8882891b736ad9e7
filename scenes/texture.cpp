#include "texture.h"

#include <rayloom/base/det_math.h>

#include <array>
#include <cmath>

namespace rayloom::scenes {
namespace {

double linearised(double encoded) {
  if (encoded <= 0.04045) return encoded / 12.92;
  return det::pow((encoded + 0.055) / 1.055, 2.4);
}

const std::array<float, 256>& srgb_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values;
    for (size_t i = 0; i < 256; ++i) values[i] = static_cast<float>(linearised(static_cast<double>(i) / 255.0));
    return values;
  }();
  return table;
}

glm::vec4 texel_of_bytes(const uint8_t* texel, Encoding encoding) {
  const float alpha = static_cast<float>(texel[3]) / 255.0f;
  if (encoding == Encoding::linear) {
    return {static_cast<float>(texel[0]) / 255.0f, static_cast<float>(texel[1]) / 255.0f,
            static_cast<float>(texel[2]) / 255.0f, alpha};
  }
  const auto& table = srgb_table();
  return {table[texel[0]], table[texel[1]], table[texel[2]], alpha};
}

glm::vec4 texel_of_floats(const float* texel, Encoding encoding) {
  if (encoding == Encoding::linear) return {texel[0], texel[1], texel[2], texel[3]};
  return {srgb_to_linear(texel[0]), srgb_to_linear(texel[1]), srgb_to_linear(texel[2]), texel[3]};
}

/// A coordinate in [0, 2) that means the same for every wrap mode but clamping, so that texel numbers stay small.
double reduced(float coordinate, Wrap wrap) {
  if (!std::isfinite(coordinate)) return 0;
  const double u = coordinate;
  if (wrap == Wrap::clamp_to_edge) return std::fmin(std::fmax(u, 0.0), 1.0);
  return u - 2 * std::floor(u / 2);
}

struct Axis {
  uint32_t low, high;
  float weight;  ///< of high
};

Axis linear_axis(float coordinate, Wrap wrap, uint32_t size) {
  const double position = reduced(coordinate, wrap) * size - 0.5;
  const double floor = std::floor(position);
  const auto texel = static_cast<int64_t>(floor);
  return {wrap_texel(wrap, texel, size), wrap_texel(wrap, texel + 1, size), static_cast<float>(position - floor)};
}

uint32_t nearest_texel(float coordinate, Wrap wrap, uint32_t size) {
  return wrap_texel(wrap, static_cast<int64_t>(std::floor(reduced(coordinate, wrap) * size)), size);
}

glm::vec4 mix(const glm::vec4& a, const glm::vec4& b, float weight) { return a * (1.0f - weight) + b * weight; }

}  // namespace

float srgb_to_linear(float encoded) { return static_cast<float>(linearised(encoded)); }

uint32_t wrap_texel(Wrap wrap, int64_t texel, uint32_t size) {
  const int64_t n = size;
  if (wrap == Wrap::clamp_to_edge) return static_cast<uint32_t>(texel < 0 ? 0 : texel >= n ? n - 1 : texel);
  const int64_t period = wrap == Wrap::repeat ? n : 2 * n;
  const int64_t inside = (texel % period + period) % period;
  return static_cast<uint32_t>(inside < n ? inside : period - 1 - inside);
}

glm::vec4 fetch_texel(const Image& image, uint32_t x, uint32_t y, Encoding encoding) {
  const Pixels& pixels = image.pixels();
  const size_t index = 4 * (size_t{y} * pixels.width + x);
  return pixels.bytes.empty() ? texel_of_floats(&pixels.floats[index], encoding)
                              : texel_of_bytes(&pixels.bytes[index], encoding);
}

glm::vec4 sample_texture(const Scene& scene, const Texture& texture, glm::vec2 uv, Encoding encoding) {
  const Image& image = *scene.images[texture.image];
  const Pixels& pixels = image.pixels();
  if (texture.filter == Filter::nearest) {
    return fetch_texel(image, nearest_texel(uv.x, texture.wrap_u, pixels.width),
                       nearest_texel(uv.y, texture.wrap_v, pixels.height), encoding);
  }
  const Axis x = linear_axis(uv.x, texture.wrap_u, pixels.width);
  const Axis y = linear_axis(uv.y, texture.wrap_v, pixels.height);
  const auto texel = [&](uint32_t column, uint32_t row) { return fetch_texel(image, column, row, encoding); };
  return mix(mix(texel(x.low, y.low), texel(x.high, y.low), x.weight),
             mix(texel(x.low, y.high), texel(x.high, y.high), x.weight), y.weight);
}

glm::vec4 sample_texture(const Scene& scene, const TextureRef& ref, glm::vec2 uv0, glm::vec2 uv1, Encoding encoding) {
  if (!ref.exists()) return glm::vec4(1);
  return sample_texture(scene, scene.textures[ref.texture], ref.map(ref.uv_set == 0 ? uv0 : uv1), encoding);
}

}  // namespace rayloom::scenes
