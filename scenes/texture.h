#pragma once

// Texture lookup with the same bits everywhere. Lookups filter in linear light: texels are linearised first.

#include <rayloom/scenes/scene.h>

namespace rayloom::scenes {

/// How the three colour channels are encoded. Alpha is always linear.
enum class Encoding : uint8_t { linear, srgb };

/// IEC 61966-2-1's transfer function, in double, rounded once. Below 0: unchanged; above 1: the curve goes on.
float srgb_to_linear(float encoded);

/// The texel an integer coordinate of any size means in an image `size` texels wide.
uint32_t wrap_texel(Wrap wrap, int64_t texel, uint32_t size);

/// Texel as four floats, linearised. Decodes the image if this is its first use (may throw InputError).
glm::vec4 fetch_texel(const Image& image, uint32_t x, uint32_t y, Encoding encoding);

/// The texture at uv, v downwards from the first row (glTF). NaN and infinite coordinates count as 0.
glm::vec4 sample_texture(const Scene& scene, const Texture& texture, glm::vec2 uv, Encoding encoding);

/// Through a material's reference: picks the uv set and maps it. White when the reference is empty.
glm::vec4 sample_texture(const Scene& scene, const TextureRef& ref, glm::vec2 uv0, glm::vec2 uv1, Encoding encoding);

}  // namespace rayloom::scenes
