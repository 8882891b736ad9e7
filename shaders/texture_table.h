#pragma once

// The textures of a scene as shaders sample them. Pixels stay in scenes::Image and are decoded when first sampled, so
// they have no place in device memory; for a tracer that observes shaders, each image has a range of simulated
// addresses beyond all device memory, and every texel read is reported there.

#include <rayloom/scenes/scene.h>
#include <rayloom/shaders/vector_math.h>

namespace rayloom::shaders {

class TextureTable {
 public:
  explicit TextureTable(const scenes::Scene& scene) : scene_(scene) {}

  /// `color`: sRGB encoded RGB, as base colour and emissive textures are; the result is linear. The first sample of an
  /// image decodes it and throws InputError when it cannot.
  float4 sample(const scenes::TextureRef& ref, float2 uv, bool color) const;

  /// Where image `image`'s texels are reported: 4 bytes each, row after row.
  static constexpr uint64_t first_address = uint64_t{1} << 48;
  static constexpr uint64_t image_bytes = uint64_t{1} << 34;
  static constexpr uint64_t image_address(uint32_t image) { return first_address + image * image_bytes; }

 private:
  const scenes::Scene& scene_;
};

}  // namespace rayloom::shaders
