#pragma once

namespace rayloom::shaders {

/// How much of the light from a direction at `cosine` (0..1) to the normal a rough dielectric of normal reflectance
/// 0.04 reflects at its surface, by GGX with Smith's masking and Schlick's Fresnel: 0..1, within 0.02 (0.1 below cosine
/// 0.1). `roughness` is perceptual, 0..1.
float dielectric_albedo(float roughness, float cosine);

}  // namespace rayloom::shaders
