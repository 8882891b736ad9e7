#include <rayloom/runtime/shader_memory.h>
#include <rayloom/scenes/texture.h>
#include <rayloom/shaders/texture_table.h>

#include <cmath>

namespace rayloom::shaders {
namespace {

/// Tells the tracer of the two rows of two texels around `uv`.
void report_access(const detail::LaneObserver& report, const scenes::Texture& texture, const scenes::Pixels& pixels,
                   float2 uv) {
  const auto texel = [&](float coordinate, uint32_t size, scenes::Wrap wrap, int step) {
    const double position = std::isfinite(coordinate) ? static_cast<double>(coordinate) * size - 0.5 : 0.0;
    const auto whole = static_cast<int64_t>(std::floor(std::fmin(std::fmax(position, -0x1p52), 0x1p52)));
    return scenes::wrap_texel(wrap, whole + step, size);
  };
  const uint32_t x = texel(uv.x, pixels.width, texture.wrap_u, 0);
  for (int step = 0; step < 2; ++step) {
    const uint32_t y = texel(uv.y, pixels.height, texture.wrap_v, step);
    report.tracer->access(report.lane, AccessKind::load,
                          TextureTable::image_address(texture.image) + 4 * (uint64_t{y} * pixels.width + x), 8,
                          nullptr);
  }
}

}  // namespace

float4 TextureTable::sample(const scenes::TextureRef& ref, float2 uv, bool color) const {
  const scenes::Texture& texture = scene_.textures[ref.texture];
  const float2 at = ref.map(uv);
  const float4 texel =
      scenes::sample_texture(scene_, texture, at, color ? scenes::Encoding::srgb : scenes::Encoding::linear);
  if (const auto* observer = detail::shader_memory.observer) [[unlikely]]
    report_access(*observer, texture, scene_.images[texture.image]->pixels(), at);
  return texel;
}

}  // namespace rayloom::shaders
