#pragma once

#include <rayloom/shaders/environment.h>
#include <rayloom/shaders/path_tracer/payload.h>
#include <rayloom/shaders/path_tracer/settings.h>

namespace rayloom::shaders {

/// The sky.
struct PathTracerMiss {
  PathTracerSettings settings;

  void operator()(MissContext& ctx, PathPayload& payload) const {
    const EnvironmentView& sky = settings.scene.environment;
    payload.emitted = float3(0);
    if (settings.scene.has_environment()) {
      const float light_pdf = payload.pdf > 0 ? environment_pdf(sky, ctx.WorldRayDirection()) /
                                                    static_cast<float>(settings.scene.light_kinds())
                                              : 0.0f;
      payload.emitted = environment_radiance(sky, ctx.WorldRayDirection()) *
                        bsdf_sample_weight(settings.estimator, payload.pdf, light_pdf);
    }
    payload.hit = 0;
    payload.pdf = 0;
    payload.shadow_t_max = 0;
  }
};

}  // namespace rayloom::shaders
