#pragma once

#include <rayloom/shaders/scene_view.h>

namespace rayloom::shaders {

/// How direct light is estimated. All three have the same expected value; the single strategies are for tests.
enum class Estimator : uint32_t { mis, light_sampling, bsdf_sampling };

struct PathTracerSettings {
  SceneView scene;
  Estimator estimator = Estimator::mis;
  uint32_t max_bounces = 8;
  float dielectric_specular = 1;  ///< scales the coat of dielectrics; 0 leaves pure Lambert, for furnace tests
};

/// Weight of a sample drawn with density `pdf` that the other strategy would have drawn with `other` (Veach's power
/// heuristic, exponent 2).
inline float mis_weight(float pdf, float other) { return 1.0f / (1.0f + square(other / pdf)); }

inline float light_sample_weight(Estimator estimator, float light_pdf, float bsdf_pdf) {
  return estimator == Estimator::mis ? mis_weight(light_pdf, bsdf_pdf) : 1.0f;
}

/// `bsdf_pdf` 0 (camera ray) or `light_pdf` 0 (no light sample finds this point): nothing to share with.
inline float bsdf_sample_weight(Estimator estimator, float bsdf_pdf, float light_pdf) {
  if (!(bsdf_pdf > 0 && light_pdf > 0) || estimator == Estimator::bsdf_sampling) return 1.0f;
  return estimator == Estimator::mis ? mis_weight(bsdf_pdf, light_pdf) : 0.0f;
}

}  // namespace rayloom::shaders
