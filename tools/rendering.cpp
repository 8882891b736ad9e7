#include <rayloom/tools/rendering.h>

#include <rayloom/base/progress.h>
#include <rayloom/tools/environment_option.h>
#include <rayloom/tools/interrupt.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr uint64_t batch_ns = 300'000'000;

}  // namespace

shaders::Renderer make_renderer(const scenes::Scene& scene, const RenderOptions& o, Tracer* tracer) {
  shaders::RenderOptions options;
  options.program = o.shader;
  options.width = o.size.width;
  options.height = o.size.height;
  options.seed = static_cast<uint32_t>(o.seed);
  options.sampler = o.sampler;
  options.max_bounces = static_cast<uint32_t>(o.max_bounces);
  options.camera =
      scenes::choose_camera(scene, o.camera, static_cast<float>(o.size.width) / static_cast<float>(o.size.height));
  if (o.pixel) options.window = shaders::Window{o.pixel->x, o.pixel->y, 1, 1};
  options.dispatch.mode = tracer ? ExecutionMode::warp : o.mode;
  options.dispatch.tracer = tracer;
  return {scene, options};
}

bool render_samples(shaders::Renderer& renderer, const RenderOptions& options, const CommonOptions& common,
                    const std::string& label) {
  const auto spp = static_cast<uint32_t>(renderer.program().samples ? options.spp : 1);
  const uint64_t pixels = uint64_t{renderer.window().width} * renderer.window().height;
  std::optional<Progress> progress;
  if (!common.quiet) progress.emplace(label, pixels * spp, "samples");
  uint32_t batch = 1;
  while (renderer.samples() < spp) {
    if (interrupt_requested()) return false;
    const uint32_t first = renderer.samples(), count = std::min(batch, spp - first);
    const Stopwatch watch;
    renderer.render(first, count);
    if (watch.ns() * 2 < batch_ns) batch *= 2;
    if (progress) progress->advance(pixels * count);
  }
  return true;
}

scenes::Scene load_scene(const RenderOptions& o, const CommonOptions& common) {
  scenes::Scene scene = scenes::load_scene(o.scene);
  apply_environment(scene, o.environment, o.environment_scale);
  if (common.quiet) return scene;
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "rayloom: warning: {}: {}\n", o.scene, warning);
  return scene;
}

Json to_json(const shaders::Renderer& renderer, uint64_t render_time_ns) {
  const DispatchStatistics& s = renderer.statistics();
  const shaders::SceneUploadReport& upload = renderer.device_scene().report();
  const double seconds = static_cast<double>(std::max<uint64_t>(render_time_ns, 1)) * 1e-9;
  return {{"samples_per_pixel", renderer.samples()},
          {"render_time_ns", render_time_ns},
          {"rays", s.rays},
          {"rays_per_second", static_cast<double>(s.rays) / seconds},
          {"hits", s.hits},
          {"shader_invocations",
           {{"ray_generation", s.ray_generation},
            {"intersection", s.intersection},
            {"any_hit", s.any_hit},
            {"closest_hit", s.closest_hit},
            {"miss", s.miss},
            {"callable", s.callable}}},
          {"triangles", upload.triangles},
          {"spheres", upload.spheres},
          {"instances", upload.instances},
          {"geometry_bytes", upload.geometry_bytes},
          {"structure_bytes", upload.structure_bytes},
          {"default_sky", renderer.uses_default_sky()}};
}

}  // namespace rayloom::tools
