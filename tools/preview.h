#pragma once

// From linear values to eight bits a channel that a screen shows. Deterministic: no libm.

#include <rayloom/tools/image.h>

#include <array>
#include <span>

namespace rayloom::tools {

/// none: clamp to [0,1], for pictures that are not light (normals, barycentrics). neutral: the Khronos PBR Neutral tone
/// mapper (KhronosGroup/ToneMapping), which leaves base colours as they are and compresses from 0.76 up.
enum class ToneMap { none, neutral };

std::array<float, 3> tone_map_neutral(std::array<float, 3> color);

/// One linear value in [0,1] (clamped; NaN shows as 0) to sRGB (IEC 61966-2-1), rounded to nearest.
uint8_t encode_srgb(float linear);

/// `exposure` stops brighter, tone mapped and sRGB encoded. Takes R, G, B.
Preview make_preview(const Image& image, ToneMap tone_map, float exposure_stops);

/// A heat map: 0 black, then blue, magenta, orange, yellow, white at `top` and above; infinite values are white, NaN
/// green.
Preview make_heat_map(uint32_t width, uint32_t height, std::span<const float> values, float top);

/// The value below which `fraction` of the finite values lie (nearest rank), 0 when there are none: a heat map's top
/// that one odd pixel cannot spoil.
float quantile(std::span<const float> values, double fraction);

}  // namespace rayloom::tools
