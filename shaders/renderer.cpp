#include <rayloom/base/error.h>
#include <rayloom/scenes/camera.h>
#include <rayloom/shaders/aov/payload.h>
#include <rayloom/shaders/film.h>
#include <rayloom/shaders/renderer.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace rayloom::shaders {
namespace {

scenes::SceneCamera camera_of(const scenes::Scene& scene, const RenderOptions& options) {
  if (options.camera) return *options.camera;
  return scenes::choose_camera(scene, "", static_cast<float>(options.width) / static_cast<float>(options.height));
}

Window checked_window(const RenderOptions& options) {
  if (options.width == 0 || options.height == 0) throw UsageError("the picture has no pixels");
  const Window window = options.window.value_or(Window{0, 0, options.width, options.height});
  const bool inside = window.x < options.width && window.width <= options.width - window.x &&
                      window.y < options.height && window.height <= options.height - window.y;
  if (!inside || window.width == 0 || window.height == 0)
    throw UsageError("the window or pixel does not lie in the picture");
  return window;
}

bool has_light(const scenes::Scene& scene) {
  return scene.environment.kind != scenes::Environment::Kind::none || !scene.lights.empty() ||
         std::any_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m.emits(); });
}

/// A scene's own sky, unless the options or the lack of any light say otherwise.
scenes::Environment environment_of(const scenes::Scene& scene, const RenderOptions& options) {
  if (options.environment) return *options.environment;
  return has_light(scene) ? scene.environment : default_sky();
}

struct FloatChannel {
  const char* name;
  float (*value)(const AovPayload&);
};
constexpr FloatChannel float_channels[] = {
    {"Z", [](const AovPayload& p) { return p.depth; }},
    {"rayT", [](const AovPayload& p) { return p.ray_t; }},
    {"P.X", [](const AovPayload& p) { return p.position.x; }},
    {"P.Y", [](const AovPayload& p) { return p.position.y; }},
    {"P.Z", [](const AovPayload& p) { return p.position.z; }},
    {"N.X", [](const AovPayload& p) { return p.normal.x; }},
    {"N.Y", [](const AovPayload& p) { return p.normal.y; }},
    {"N.Z", [](const AovPayload& p) { return p.normal.z; }},
    {"Ns.X", [](const AovPayload& p) { return p.shading_normal.x; }},
    {"Ns.Y", [](const AovPayload& p) { return p.shading_normal.y; }},
    {"Ns.Z", [](const AovPayload& p) { return p.shading_normal.z; }},
    {"Albedo.R", [](const AovPayload& p) { return p.albedo.x; }},
    {"Albedo.G", [](const AovPayload& p) { return p.albedo.y; }},
    {"Albedo.B", [](const AovPayload& p) { return p.albedo.z; }},
    {"uv.U", [](const AovPayload& p) { return p.uv.x; }},
    {"uv.V", [](const AovPayload& p) { return p.uv.y; }},
    {"occlusion", [](const AovPayload& p) { return p.occlusion; }},
    {"facing", [](const AovPayload& p) { return p.facing; }},
};

struct IdChannel {
  const char* name;
  uint32_t (*value)(const AovPayload&);
};
constexpr IdChannel id_channels[] = {
    {"id.instance", [](const AovPayload& p) { return p.instance; }},
    {"id.geometry", [](const AovPayload& p) { return p.geometry; }},
    {"id.primitive", [](const AovPayload& p) { return p.primitive; }},
    {"id.material", [](const AovPayload& p) { return p.material; }},
};

float4 mean_of(const PixelSums& sums, double samples) {
  return {float3(sums.color / samples), static_cast<float>(sums.alpha / samples)};
}

float3 variance_of_mean(const PixelSums& sums, double n) {
  if (n < 2) return float3(0);
  const glm::dvec3 deviation = sums.squares - sums.color * sums.color / n;
  return float3(glm::max(deviation, glm::dvec3(0)) / ((n - 1) * n));
}

}  // namespace

struct Renderer::State {
  RenderOptions options;
  const ProgramInfo& info;
  Window window;
  scenes::SceneCamera camera;
  scenes::Environment environment;
  bool default_sky;
  Device device;
  DeviceScene scene;
  ProgramOptions program_options;
  Program program;
  Buffer pixels;
  uint32_t samples = 0;
  DispatchStatistics statistics;
  DispatchReport last;

  State(const scenes::Scene& source, RenderOptions o)
      : options(std::move(o)),
        info(find_program(options.program)),
        window(checked_window(options)),
        camera(camera_of(source, options)),
        environment(environment_of(source, options)),
        default_sky(info.lights && !options.environment && !has_light(source)),
        scene(device, source, {info.lights, &environment}),
        program_options{Camera(camera, {options.width, options.height}), options.estimator, options.max_bounces,
                        options.dielectric_specular, options.occlusion_distance},
        program(make_program(info.name, device, scene, program_options)),
        pixels(device.create_buffer(pixel_count() * sizeof(PixelSums))) {}

  uint64_t pixel_count() const { return uint64_t{window.width} * window.height; }

  void dispatch(const Program& which, uint32_t first, uint32_t count, const DispatchOptions& how) {
    FilmArguments film;
    film.pixels = pixels.rw_structured<PixelSums>();
    film.window_origin = {window.x, window.y};
    film.window_size = {window.width, window.height};
    film.first_sample = first, film.sample_count = count;
    film.seed = options.seed;
    film.sampler = options.sampler;
    CommandList commands;
    commands.SetPipelineState1(which.pipeline);
    commands.SetComputeRoot(film);
    commands.DispatchRays(which.dispatch(window.width, window.height));
    last = device.execute(commands, how).dispatches.at(0);
    statistics += last.statistics;
  }
};

Renderer::Renderer(const scenes::Scene& scene, RenderOptions options)
    : state_(std::make_unique<State>(scene, std::move(options))) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::render(uint32_t first, uint32_t count) {
  State& s = *state_;
  if (count == 0) return;
  if (!s.info.samples) {
    if (s.samples == 0) s.dispatch(s.program, 0, 1, s.options.dispatch);
    s.samples = 1;
    return;
  }
  if (first != s.samples) throw UsageError("sample ranges must follow each other");
  s.dispatch(s.program, first, count, s.options.dispatch);
  s.samples += count;
}

void Renderer::restart(uint32_t seed, SamplerKind sampler) {
  State& s = *state_;
  s.options.seed = seed, s.options.sampler = sampler;
  s.samples = 0;
  const auto sums = s.pixels.as<PixelSums>();
  std::fill(sums.begin(), sums.end(), PixelSums{});
}

Picture Renderer::picture() const {
  const State& s = *state_;
  Picture picture{s.window.width, s.window.height, s.samples, {}, {}};
  const double n = std::max(1u, s.samples);
  for (const PixelSums& sums : s.pixels.as<PixelSums>().first(s.pixel_count())) {
    picture.rgba.push_back(mean_of(sums, n));
    picture.variance.push_back(variance_of_mean(sums, n));
  }
  return picture;
}

std::vector<AovChannel> Renderer::aov_channels() {
  State& s = *state_;
  const Buffer buffer = s.device.create_buffer(s.pixel_count() * sizeof(AovPayload));
  DispatchOptions native = s.options.dispatch;
  native.tracer = nullptr;
  s.dispatch(make_aov_channels(s.device, s.scene, s.program_options, buffer.rw_structured<AovPayload>()), 0, 1, native);
  const auto payloads = buffer.as<AovPayload>().first(s.pixel_count());
  std::vector<AovChannel> channels;
  for (const FloatChannel& channel : float_channels) {
    channels.push_back({channel.name, std::vector<float>(payloads.size()), {}});
    std::transform(payloads.begin(), payloads.end(), channels.back().values.begin(), channel.value);
  }
  for (const IdChannel& channel : id_channels) {
    channels.push_back({channel.name, {}, std::vector<uint32_t>(payloads.size())});
    std::transform(payloads.begin(), payloads.end(), channels.back().ids.begin(), channel.value);
  }
  return channels;
}

void Renderer::set_dispatch(const DispatchOptions& how) { state_->options.dispatch = how; }

const RenderOptions& Renderer::options() const { return state_->options; }
const ProgramInfo& Renderer::program() const { return state_->info; }
Window Renderer::window() const { return state_->window; }
uint32_t Renderer::samples() const { return state_->samples; }
bool Renderer::uses_default_sky() const { return state_->default_sky; }
const scenes::SceneCamera& Renderer::camera() const { return state_->camera; }
const DeviceScene& Renderer::device_scene() const { return state_->scene; }
const Device& Renderer::device() const { return state_->device; }
const Buffer& Renderer::film() const { return state_->pixels; }
const DispatchStatistics& Renderer::statistics() const { return state_->statistics; }
const DispatchReport& Renderer::last_dispatch() const { return state_->last; }

scenes::Environment default_sky() {
  scenes::Environment sky;
  sky.kind = scenes::Environment::Kind::gradient;
  sky.zenith = float3(0.35f, 0.5f, 0.85f);
  sky.horizon = float3(0.8f, 0.85f, 0.9f);
  sky.nadir = float3(0.25f, 0.22f, 0.2f);
  return sky;
}

std::vector<std::string> aov_channel_names() {
  std::vector<std::string> names;
  for (const FloatChannel& channel : float_channels) names.emplace_back(channel.name);
  for (const IdChannel& channel : id_channels) names.emplace_back(channel.name);
  return names;
}

}  // namespace rayloom::shaders
