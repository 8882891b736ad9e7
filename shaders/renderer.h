#pragma once

// Renders a scene with one of the programs: set up once, then accumulate sample ranges, then take the picture. The
// caller chooses the ranges (for progress or partial results); the bits do not depend on them, nor on threads,
// instruction set or execution mode.

#include <rayloom/scenes/scene.h>
#include <rayloom/shaders/program.h>
#include <rayloom/shaders/sampler_kind.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rayloom::shaders {

/// A rectangle of pixels, origin top left.
struct Window {
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

struct RenderOptions {
  std::string program = "path_tracer";
  uint32_t width = 640, height = 360;
  uint32_t seed = 0;
  SamplerKind sampler = SamplerKind::owen_sobol;
  uint32_t max_bounces = 8;  ///< scatterings a path may have; 0 shows emission alone
  Estimator estimator = Estimator::mis;
  float dielectric_specular = 1;                   ///< see PathTracerSettings
  float occlusion_distance = INFINITY;             ///< of ambient_occlusion, metres
  std::optional<scenes::SceneCamera> camera;       ///< else scenes::choose_camera(scene, "", aspect)
  std::optional<scenes::Environment> environment;  ///< instead of the scene's
  std::optional<Window> window;                    ///< part of the picture; each pixel's bits are those of the whole
  DispatchOptions dispatch;                        ///< execution mode, warp size, tracer
};

/// Row by row, top row first, of the window.
struct Picture {
  uint32_t width = 0, height = 0;
  uint32_t samples = 0;
  std::vector<float4> rgba;      ///< linear Rec. 709 means; alpha is the covered share
  std::vector<float3> variance;  ///< of each mean: sample variance over the number of samples; 0 below two samples
};

/// A named channel of the first hit at each pixel's centre. One of the vectors is filled.
struct AovChannel {
  std::string name;  ///< as in EXR files: "Z", "N.X", "id.instance"
  std::vector<float> values;
  std::vector<uint32_t> ids;
};

class Renderer {
 public:
  /// Uploads the scene. A scene without any light gets default_sky(). UsageError for an unknown program or an empty
  /// size or window; InputError for bad scenes. `scene` must outlive it.
  Renderer(const scenes::Scene& scene, RenderOptions options);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  /// Adds samples first .. first + count - 1 of every pixel of the window. Ranges must follow each other from 0.
  /// Programs without samples trace once, whatever the range.
  void render(uint32_t first, uint32_t count);
  Picture picture() const;
  /// Traces one more ray a pixel, always with the native tracer. Depth and distance are infinite and ids 0xffffffff
  /// where nothing is hit.
  std::vector<AovChannel> aov_channels();

  /// Forgets all samples and begins another picture of the scene: the bits of a new Renderer with this seed and
  /// sampler.
  void restart(uint32_t seed, SamplerKind sampler);

  /// How the render() calls that follow run: mode, warp size, tracer.
  void set_dispatch(const DispatchOptions& how);

  const RenderOptions& options() const;
  const ProgramInfo& program() const;
  Window window() const;
  uint32_t samples() const;
  bool uses_default_sky() const;
  const scenes::SceneCamera& camera() const;
  const DeviceScene& device_scene() const;
  const Device& device() const;
  /// The window's PixelSums (film.h), row by row: picture() reads them, and a replay may put its own in their place.
  const Buffer& film() const;
  /// Of all dispatches so far; the report of the last one.
  const DispatchStatistics& statistics() const;
  const DispatchReport& last_dispatch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Blue above, bright at the horizon, earth below: what scenes without lights are seen under.
scenes::Environment default_sky();

/// Names of the channels aov_channels() gives, in its order.
std::vector<std::string> aov_channel_names();

}  // namespace rayloom::shaders
