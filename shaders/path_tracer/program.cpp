#include <rayloom/shaders/path_tracer/closest_hit.h>
#include <rayloom/shaders/path_tracer/light_callables.h>
#include <rayloom/shaders/path_tracer/miss.h>
#include <rayloom/shaders/path_tracer/ray_generation.h>
#include <rayloom/shaders/pipeline_builder.h>

namespace rayloom::shaders {

Program make_path_tracer(Device& device, const DeviceScene& scene, const ProgramOptions& options) {
  const SceneView& view = scene.view();
  const PathTracerSettings settings{view, options.estimator, options.max_bounces, options.dielectric_specular};
  PipelineBuilder builder(device, scene);
  builder.ray_generation(PathTracerRayGeneration{settings, options.camera});
  builder.radiance<PathPayload>(PathTracerTriangleHit{settings}, PathTracerSphereHit{settings}, cost::path_vertex);
  builder.miss("Miss", PathTracerMiss{settings}, cost::sky);
  builder.shadow();
  if (view.has_environment()) builder.callable("SampleEnvironment", SampleEnvironmentLight{view.environment});
  if (view.has_triangle_lights()) builder.callable("SampleTriangles", SampleTriangleLight{view});
  if (view.has_punctual_lights()) builder.callable("SamplePunctual", SamplePunctualLight{view.lights});
  return builder.build();
}

}  // namespace rayloom::shaders
