#pragma once

// glTF 2.0's metallic-roughness reflection (specification, appendix B): a Lambert base under a GGX coat with Schlick's
// Fresnel. All directions are unit, local to the shading frame (normal +z) and point away from the surface.
//
// One departure, which the specification permits: its sample code weighs the base by 1 - F at the half vector, which at
// grazing angles reflects up to 1.7 times what arrives. Here the base gets what the coat's directional albedo leaves of
// the light on its way in or out, whichever is less: reciprocal, and never
// more than arrives (but for up to 2 % where the albedo's table is coarse: roughness below 0.2 seen at a grazing
// angle).

#include <rayloom/shaders/dielectric_albedo.h>
#include <rayloom/shaders/ggx.h>
#include <rayloom/shaders/vector_math.h>
#include <rayloom/shaders/warp.h>

namespace rayloom::shaders {

struct BsdfValue {
  float3 reflected;  ///< f(wo, wi) * cos(wi): what is left of radiance from wi, per steradian
  float pdf;         ///< density of sample_bsdf at wi, per steradian
};

struct BsdfSample {
  float3 wi;
  float3 weight;  ///< f * cos / pdf
  float pdf;      ///< 0: the sample went below the surface, the path ends
};

/// The parameters of one shading point. Light scattered more than once between microfacets is lost, as in the
/// specification.
struct Bsdf {
  float3 diffuse;         ///< albedo of the Lambert base, 0..1
  float coat;             ///< strength of the dielectric coat over the base, 0..1
  float roughness;        ///< perceptual
  float3 f0;              ///< reflectance at normal incidence, 0..1
  float f90;              ///< reflectance at grazing incidence; 0 with f0 = 0 makes the surface purely Lambert
  float alpha;            ///< roughness squared, at least min_alpha
  float specular_chance;  ///< probability that sample_bsdf takes the coat, see with_specular_chance
};

/// Schlick's approximation. `cosine` in 0..1.
inline float3 fresnel(const Bsdf& bsdf, float cosine) {
  const float m = 1.0f - cosine, m2 = m * m;
  return bsdf.f0 + (float3(bsdf.f90) - bsdf.f0) * (m2 * m2 * m);
}

/// What the coat leaves for the base of light at these two cosines.
inline float base_weight(const Bsdf& bsdf, float cos_o, float cos_i) {
  return 1.0f -
         bsdf.coat * std::fmax(dielectric_albedo(bsdf.roughness, cos_o), dielectric_albedo(bsdf.roughness, cos_i));
}

/// Base colour and factors as glTF defines them. `specular` scales the dielectric coat (KHR_materials_specular's
/// factor; 1 is plain glTF, whose dielectric reflects 0.04).
inline Bsdf metallic_roughness(float3 base_color, float metallic, float roughness, float specular = 1.0f) {
  Bsdf bsdf;
  bsdf.diffuse = base_color * (1.0f - metallic);
  bsdf.coat = specular;
  bsdf.roughness = roughness;
  bsdf.f0 = glm::mix(float3(0.04f * specular), base_color, metallic);
  bsdf.f90 = glm::mix(specular, 1.0f, metallic);
  bsdf.alpha = std::fmax(roughness * roughness, min_alpha);
  bsdf.specular_chance = 1.0f;
  return bsdf;
}

/// Chooses between the lobes in proportion to what they may reflect towards `wo`, neither starved below a tenth.
inline Bsdf with_specular_chance(Bsdf bsdf, float3 wo) {
  const float specular = luminance(fresnel(bsdf, saturate(wo.z)));
  const float diffuse = luminance(bsdf.diffuse) * (1.0f - specular);
  if (!(diffuse > 0)) return bsdf.specular_chance = 1.0f, bsdf;
  if (!(specular > 0)) return bsdf.specular_chance = 0.0f, bsdf;
  bsdf.specular_chance = glm::clamp(specular / (specular + diffuse), 0.1f, 0.9f);
  return bsdf;
}

/// Zero unless both directions are above the surface.
inline BsdfValue evaluate_bsdf(const Bsdf& bsdf, float3 wo, float3 wi) {
  if (!(wo.z > 0 && wi.z > 0)) return {float3(0), 0};
  const float diffuse_pdf = wi.z * inverse_pi;
  if (bsdf.f90 == 0 && largest_component(bsdf.f0) == 0) return {bsdf.diffuse * diffuse_pdf, diffuse_pdf};

  const float3 h = glm::normalize(wo + wi);
  const float3 reflectance = fresnel(bsdf, saturate(glm::dot(wi, h)));
  const float distribution = ggx_distribution(h, bsdf.alpha);
  const float specular = distribution * ggx_masking_shadowing(wo, wi, bsdf.alpha) / (4.0f * wo.z);
  const float specular_pdf = distribution * ggx_masking(wo, bsdf.alpha) / (4.0f * wo.z);
  return {base_weight(bsdf, wo.z, wi.z) * diffuse_pdf * bsdf.diffuse + reflectance * specular,
          glm::mix(diffuse_pdf, specular_pdf, bsdf.specular_chance)};
}

/// Draws wi: `lobe` in [0, 1) chooses the lobe, `u` the direction. wo.z > 0.
inline BsdfSample sample_bsdf(const Bsdf& bsdf, float3 wo, float lobe, float2 u) {
  float3 wi;
  if (lobe < bsdf.specular_chance)
    wi = glm::reflect(-wo, ggx_sample_visible_normal(wo, bsdf.alpha, u));
  else
    wi = cosine_hemisphere(u);
  const BsdfValue value = evaluate_bsdf(bsdf, wo, wi);
  if (!(value.pdf > 0)) return {wi, float3(0), 0};
  return {wi, value.reflected / value.pdf, value.pdf};
}

}  // namespace rayloom::shaders
