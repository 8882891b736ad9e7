#include <rayloom/shaders/ambient_occlusion/shaders.h>
#include <rayloom/shaders/pipeline_builder.h>

namespace rayloom::shaders {

Program make_ambient_occlusion(Device& device, const DeviceScene& scene, const ProgramOptions& options) {
  PipelineBuilder builder(device, scene);
  builder.ray_generation(OcclusionRayGeneration{scene.view(), options.camera, options.occlusion_distance});
  builder.radiance<OcclusionPayload>(OcclusionTriangleHit, OcclusionSphereHit);
  builder.miss("Miss", OcclusionMiss);
  builder.shadow();
  return builder.build();
}

}  // namespace rayloom::shaders
