#pragma once

// Light sampling as callable shaders, one a kind of light, in this order among the kinds a scene has: sky, emissive
// triangles, punctual lights. A closest-hit shader picks a kind and calls it by its index.

#include <rayloom/runtime/stage_context.h>
#include <rayloom/shaders/lights.h>

namespace rayloom::shaders {

struct SampleEnvironmentLight {
  EnvironmentView environment;
  void operator()(CallableContext&, LightSample& sample) const { sample_environment_light(environment, sample); }
};

struct SampleTriangleLight {
  SceneView scene;
  void operator()(CallableContext&, LightSample& sample) const { sample_triangle_light(scene, sample); }
};

struct SamplePunctualLight {
  LightView lights;
  void operator()(CallableContext&, LightSample& sample) const { sample_punctual_light(lights, sample); }
};

}  // namespace rayloom::shaders
