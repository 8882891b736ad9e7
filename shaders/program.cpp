#include <rayloom/base/error.h>
#include <rayloom/shaders/aov/views.h>
#include <rayloom/shaders/program.h>

#include <algorithm>

namespace rayloom::shaders {
namespace {

std::vector<ProgramInfo> list_programs() {
  std::vector<ProgramInfo> list{
      {"path_tracer", "global illumination: metallic-roughness GGX, light sampling with MIS", true, true},
      {"ambient_occlusion", "the open share of the hemisphere over the first hit", true, false},
      {"barycentrics", "the DXR lecture's example: barycentrics of the first hit", false, false},
  };
  for (const AovViewInfo& view : aov_views())
    list.push_back({std::string(view.name), std::string(view.description), false, false});
  return list;
}

}  // namespace

DISPATCH_RAYS_DESC Program::dispatch(uint32_t width, uint32_t height) const {
  DISPATCH_RAYS_DESC desc;
  desc.RayGenerationShaderRecord = ray_generation;
  desc.MissShaderTable = miss;
  desc.HitGroupTable = hit_groups;
  if (callables.count() > 0) desc.CallableShaderTable = callables;
  desc.Width = width;
  desc.Height = height;
  desc.Depth = 1;
  return desc;
}

const std::vector<ProgramInfo>& programs() {
  static const std::vector<ProgramInfo> list = list_programs();
  return list;
}

const ProgramInfo& find_program(std::string_view name) {
  std::string names;
  for (const ProgramInfo& program : programs()) {
    if (program.name == name) return program;
    names += (names.empty() ? "" : ", ") + program.name;
  }
  throw UsageError("no shader program is called '" + std::string(name) + "'; there are " + names);
}

Program make_program(std::string_view name, Device& device, const DeviceScene& scene, const ProgramOptions& options) {
  const ProgramInfo& info = find_program(name);
  if (info.name == "path_tracer") return make_path_tracer(device, scene, options);
  if (info.name == "ambient_occlusion") return make_ambient_occlusion(device, scene, options);
  if (info.name == "barycentrics") return make_barycentrics(device, scene, options);
  return make_aov_view(device, scene, options, name);
}

}  // namespace rayloom::shaders
