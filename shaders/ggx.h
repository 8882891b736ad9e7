#pragma once

// The isotropic GGX microfacet distribution (Walter et al. 2007) with Smith's height-correlated masking and shadowing
// (Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs"). Directions are unit, local to
// the surface (normal +z) and point away from it.

#include <rayloom/shaders/vector_math.h>
#include <rayloom/shaders/warp.h>

#include <cmath>

namespace rayloom::shaders {

/// Smaller alphas lose the precision of float half vectors; a mirror is this smooth.
inline constexpr float min_alpha = 1e-3f;

/// Density of microfacet normals, per projected area. The quadratic form keeps its precision near the pole, where
/// 1 - cos^2 would not.
inline float ggx_distribution(float3 h, float alpha) {
  const float form = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
  return inverse_pi / (alpha * alpha * form * form);
}

/// Smith's Lambda: the ratio of hidden to visible microfacet area.
inline float ggx_lambda(float3 w, float alpha) {
  const float tangent_squared = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tangent_squared) - 1.0f);
}

inline float ggx_masking(float3 w, float alpha) { return 1.0f / (1.0f + ggx_lambda(w, alpha)); }
inline float ggx_masking_shadowing(float3 wo, float3 wi, float alpha) {
  return 1.0f / (1.0f + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha));
}

/// A microfacet normal, distributed as those seen from `wo` (wo.z > 0). Dupuy and Benyoub 2023, "Sampling Visible GGX
/// Normals with Spherical Caps".
inline float3 ggx_sample_visible_normal(float3 wo, float alpha, float2 u) {
  const float3 stretched = glm::normalize(float3(alpha * wo.x, alpha * wo.y, wo.z));
  const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
  const float3 cap = direction_at(z, u.x) + stretched;
  return glm::normalize(float3(alpha * cap.x, alpha * cap.y, std::fmax(0.0f, cap.z)));
}

/// Density of ggx_sample_visible_normal.
inline float ggx_visible_normal_pdf(float3 wo, float3 h, float alpha) {
  return ggx_masking(wo, alpha) * ggx_distribution(h, alpha) * std::fmax(0.0f, glm::dot(wo, h)) / wo.z;
}

}  // namespace rayloom::shaders
