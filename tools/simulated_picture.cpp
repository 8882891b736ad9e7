#include <rayloom/tools/simulated_picture.h>

#include <rayloom/hwmodel/recording_tracer.h>
#include <rayloom/tools/channels.h>
#include <rayloom/tools/interrupt.h>

#include <algorithm>
#include <cstdio>
#include <functional>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

Channel sum_cycles(const std::vector<std::vector<uint64_t>>& launches) {
  std::vector<float> sums;
  std::vector<uint64_t> totals(launches.front().size());
  for (const auto& launch : launches) {
    std::transform(launch.begin(), launch.end(), totals.begin(), totals.begin(), std::plus<>());
  }
  for (const uint64_t total : totals) sums.push_back(static_cast<float>(total));
  return {"hw.cycles", std::move(sums)};
}

/// Puts what the replay stored in the place of what the recording stored, and nothing else: a byte the replay did not
/// write is 0 and shows as a difference.
void take_film(const Buffer& film, const hwmodel::ShadowMemory& memory) {
  std::fill(film.host().begin(), film.host().end(), std::byte{0});
  memory.read(film.address(), film.host());
}

}  // namespace

SimulatedPicture simulate_picture(const scenes::Scene& scene, const RenderOptions& options,
                                  const hwmodel::GpuConfig& config, const CommonOptions& common) {
  hwmodel::RecordingTracer recorder;
  shaders::Renderer renderer = make_renderer(scene, options, &recorder);
  // One launch: how samples are split into launches decides clocks, so nothing that varies may.
  if (!common.quiet) fmt::print(stderr, "rayloom: capturing\n");
  renderer.render(0, static_cast<uint32_t>(options.spp));
  throw_if_interrupted();
  const std::vector<hwmodel::Capture> captures = recorder.take();

  if (!common.quiet) fmt::print(stderr, "rayloom: replaying\n");
  hwmodel::ReplayResult replayed = hwmodel::replay(captures, config);
  throw_if_interrupted();
  take_film(renderer.film(), replayed.memory);
  SimulatedPicture result{make_image(renderer, options.aovs), {}, std::move(replayed.stats)};
  result.cycles = {result.picture.width, result.picture.height, {sum_cycles(replayed.pixel_cycles)}, {}};
  return result;
}

}  // namespace rayloom::tools
