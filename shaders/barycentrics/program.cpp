#include <rayloom/shaders/barycentrics/shaders.h>
#include <rayloom/shaders/pipeline_builder.h>

namespace rayloom::shaders {

Program make_barycentrics(Device& device, const DeviceScene& scene, const ProgramOptions& options) {
  PipelineBuilder builder(device, scene);
  builder.ray_generation(BarycentricsRayGeneration{scene.view().structure, scene.ray_types(), options.camera});
  builder.radiance<BarycentricsPayload>(BarycentricsClosestHit, BarycentricsSphereHit, {16, 0});
  builder.miss("Miss", BarycentricsMiss);
  return builder.build();
}

}  // namespace rayloom::shaders
