#pragma once

// A ready DXR program: pipeline and shader tables for one scene. Each program lives in a folder of its own with its
// functors and one program.cpp that registers them; programs() lists them by name.

#include <rayloom/shaders/camera.h>
#include <rayloom/shaders/path_tracer/settings.h>
#include <rayloom/shaders/scene_to_device.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::shaders {

struct Program {
  std::shared_ptr<const StateObject> pipeline;
  ShaderTable ray_generation, miss, hit_groups, callables;

  DISPATCH_RAYS_DESC dispatch(uint32_t width, uint32_t height) const;
};

/// What programs may need beside the scene.
struct ProgramOptions {
  Camera camera;
  Estimator estimator = Estimator::mis;
  uint32_t max_bounces = 8;
  float dielectric_specular = 1;
  float occlusion_distance = INFINITY;  ///< metres: farther geometry does not occlude
};

struct ProgramInfo {
  std::string name;
  std::string description;
  bool samples = false;  ///< pixels are means over samples; otherwise one centre ray says it all
  bool lights = false;   ///< needs the scene's lights uploaded
};

/// In the order help lists them; `path_tracer` first.
const std::vector<ProgramInfo>& programs();
/// UsageError, listing the names there are, when `name` is none of them.
const ProgramInfo& find_program(std::string_view name);
Program make_program(std::string_view name, Device& device, const DeviceScene& scene, const ProgramOptions& options);

// One a folder.
Program make_barycentrics(Device& device, const DeviceScene& scene, const ProgramOptions& options);
Program make_ambient_occlusion(Device& device, const DeviceScene& scene, const ProgramOptions& options);
Program make_path_tracer(Device& device, const DeviceScene& scene, const ProgramOptions& options);
Program make_aov_view(Device& device, const DeviceScene& scene, const ProgramOptions& options, std::string_view view);
struct AovPayload;
Program make_aov_channels(Device& device, const DeviceScene& scene, const ProgramOptions& options,
                          RWStructuredBuffer<AovPayload> channels);

}  // namespace rayloom::shaders
