#include <rayloom/base/error.h>
#include <rayloom/shaders/aov/shaders.h>
#include <rayloom/shaders/pipeline_builder.h>

namespace rayloom::shaders {
namespace {

Program make_aov(Device& device, const DeviceScene& scene, const AovRayGeneration& ray_generation) {
  PipelineBuilder builder(device, scene);
  builder.ray_generation(ray_generation);
  builder.radiance<AovPayload>(AovTriangleHit{scene.view().materials}, AovSphereHit{scene.view().materials});
  builder.miss("Miss", AovMiss);
  return builder.build();
}

}  // namespace

Program make_aov_view(Device& device, const DeviceScene& scene, const ProgramOptions& options, std::string_view name) {
  for (const AovViewInfo& info : aov_views())
    if (info.name == name) return make_aov(device, scene, {scene.view(), options.camera, info.view});
  throw UsageError("no view is called '" + std::string(name) + "'");
}

Program make_aov_channels(Device& device, const DeviceScene& scene, const ProgramOptions& options,
                          RWStructuredBuffer<AovPayload> channels) {
  return make_aov(device, scene, {scene.view(), options.camera, AovView::depth, channels});
}

}  // namespace rayloom::shaders
