#include <rayloom/tools/render_options.h>

#include <rayloom/accel/trace.h>
#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>
#include <rayloom/base/version.h>
#include <rayloom/scenes/procedural/registry.h>
#include <rayloom/shaders/renderer.h>
#include <rayloom/tools/channels.h>
#include <rayloom/tools/cli.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr uint64_t max_spp = 1 << 20, max_threads = 1024, max_path_bounces = 1000;
constexpr double max_environment_scale = 1e6;

std::string program_list() {
  std::string list;
  for (const shaders::ProgramInfo& program : shaders::programs()) list += (list.empty() ? "" : " ") + program.name;
  return list;
}

std::string check_program(const std::string& name) {
  for (const shaders::ProgramInfo& program : shaders::programs()) {
    if (program.name == name) return name;
  }
  throw UsageError(fmt::format("--shader: '{}' is not one of {}", name, program_list()));
}

accel::Isa parse_isa(const std::string& name) {
  for (const accel::Isa isa : {accel::Isa::scalar, accel::Isa::avx2, accel::Isa::avx512}) {
    if (accel::isa_name(isa) != name) continue;
    if (!accel::isa_supported(isa)) throw UsageError(fmt::format("--isa: this machine has no {}", name));
    return isa;
  }
  throw UsageError(fmt::format("--isa: '{}' is not one of scalar avx2 avx512", name));
}

ExecutionMode parse_mode(const std::string& name) {
  if (name == "warp") return ExecutionMode::warp;
  if (name == "direct") return ExecutionMode::direct;
  throw UsageError(fmt::format("--mode: '{}' is not one of warp direct", name));
}

shaders::SamplerKind parse_sampler(const std::string& name) {
  if (const auto kind = shaders::find_sampler(name)) return *kind;
  throw UsageError(fmt::format("--sampler: '{}' is not one of {}", name, fmt::join(shaders::sampler_names, " ")));
}

const char* name_of(ExecutionMode mode) {
  return mode == ExecutionMode::direct ? "direct" : mode == ExecutionMode::warp ? "warp" : "automatic";
}

/// Adds an option whose text `parse` stores.
template <class Parse>
void add_parsed(CLI::App& sub, const char* name, const char* type, const std::string& description, Parse parse) {
  sub.add_option_function<std::string>(name, parse, description)->type_name(type);
}

}  // namespace

void add_render_options(CLI::App& sub, RenderOptions& o) {
  sub.add_option("SCENE", o.scene,
                 "A glTF file (.gltf, .glb) or a procedural scene: " + scenes::procedural_scene_names())
      ->required();
  add_parsed(sub, "--shader", "NAME", "Program: " + program_list() + " [path_tracer]",
             [&o](const std::string& text) { o.shader = check_program(text); });
  add_count(sub, "--spp", o.spp, 1, max_spp, "Samples a pixel");
  add_parsed(sub, "--size", "WxH", "Picture size in pixels [960x540]",
             [&o](const std::string& text) { o.size = parse_size("--size", text); });
  sub.add_option("--camera", o.camera,
                 "A camera of the file by index or name, 'frame' to show everything, or "
                 "'eye=x,y,z;at=x,y,z;up=x,y,z;fov=degrees' (or ortho=half height)")
      ->type_name("SPEC");
  sub.add_option("--environment", o.environment,
                 "What rays see that hit nothing: 'none', a radiance 'r,g,b', or a latitude-longitude picture "
                 "(its middle column looks along -z) [the scene's own]")
      ->type_name("SKY");
  add_parsed(sub, "--environment-scale", "X", "Times the radiance of --environment [1]", [&o](const std::string& text) {
    o.environment_scale = parse_real("--environment-scale", text, 0, max_environment_scale);
  });
  add_parsed(sub, "--pixel", "x,y", "Only this pixel, counted from the top left",
             [&o](const std::string& text) { o.pixel = parse_pixel("--pixel", text); });
  add_count(sub, "--seed", o.seed, 0, UINT32_MAX, "Seed of all random numbers");
  add_parsed(sub, "--sampler", "NAME", "Random numbers: owen-sobol or independent [owen-sobol]",
             [&o](const std::string& text) { o.sampler = parse_sampler(text); });
  add_count(sub, "--max-bounces", o.max_bounces, 0, max_path_bounces,
            "Scatterings a path may have, 0 for emission alone");
  add_parsed(sub, "--aov", "LIST", "Further channels, by name or layer, separated by commas: " + channel_layers(),
             [&o](const std::string& text) { o.aovs = expand_channels("--aov", parse_names("--aov", text)); });
  add_count(sub, "--threads", o.threads, 0, max_threads, "Threads, 0 for one a core; never changes the picture");
  add_parsed(sub, "--isa", "NAME", "Instruction set: scalar, avx2 or avx512; never changes the picture",
             [&o](const std::string& text) { o.isa = accel::isa_name(parse_isa(text)); });
  add_parsed(sub, "--mode", "NAME", "Execution: warp or direct; never changes the picture",
             [&o](const std::string& text) { o.mode = parse_mode(text); });
}

void apply_render_options(const RenderOptions& o) {
  if (o.pixel && (o.pixel->x >= o.size.width || o.pixel->y >= o.size.height)) {
    throw UsageError(fmt::format("--pixel: {},{} does not lie in a picture of {}x{}", o.pixel->x, o.pixel->y,
                                 o.size.width, o.size.height));
  }
  if (!o.isa.empty()) accel::set_isa(parse_isa(o.isa));
}

std::string picture_command(const RenderOptions& o) {
  std::string command =
      fmt::format("rayloom render {} --shader {} --size {}x{} --spp {} --seed {} --max-bounces {}",
                  shell_quote(o.scene), o.shader, o.size.width, o.size.height, o.spp, o.seed, o.max_bounces);
  if (o.sampler != shaders::SamplerKind::owen_sobol) command += fmt::format(" --sampler {}", name_of(o.sampler));
  if (!o.camera.empty()) command += " --camera " + shell_quote(o.camera);
  if (!o.environment.empty())
    command += fmt::format(" --environment {} --environment-scale {}", shell_quote(o.environment), o.environment_scale);
  if (o.pixel) command += fmt::format(" --pixel {},{}", o.pixel->x, o.pixel->y);
  if (!o.aovs.empty()) command += fmt::format(" --aov {}", fmt::join(o.aovs, ","));
  return command;
}

Metadata picture_metadata(const RenderOptions& o, uint64_t samples) {
  return {{"Software", fmt::format("rayloom {}", version().number)},
          {"rayloom:commit", version().commit},
          {"rayloom:scene", o.scene},
          {"rayloom:shader", o.shader},
          {"rayloom:spp", std::to_string(samples)},
          {"rayloom:seed", std::to_string(o.seed)},
          {"rayloom:command", picture_command(o)}};
}

Json to_json(const RenderOptions& o, ExecutionMode used) {
  Json json{{"scene", o.scene},
            {"shader", o.shader},
            {"width", o.size.width},
            {"height", o.size.height},
            {"spp", o.spp},
            {"seed", o.seed},
            {"sampler", name_of(o.sampler)},
            {"max_bounces", o.max_bounces},
            {"camera", o.camera},
            {"environment", o.environment},
            {"environment_scale", o.environment_scale},
            {"aov", o.aovs},
            {"threads", thread_limit()},
            {"mode", name_of(used)},
            {"command", picture_command(o)}};
  json["pixel"] = o.pixel ? Json{o.pixel->x, o.pixel->y} : Json();
  return json;
}

}  // namespace rayloom::tools
