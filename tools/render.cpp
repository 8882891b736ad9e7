// rayloom render SCENE -o FILE: a picture. Read on in shaders/renderer.cpp.

#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>
#include <rayloom/tools/channels.h>
#include <rayloom/tools/cli.h>
#include <rayloom/tools/image_io.h>
#include <rayloom/tools/interrupt.h>
#include <rayloom/tools/preview.h>
#include <rayloom/tools/rendering.h>

#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr const char* examples =
    "  rayloom render atrium -o atrium.exr -o atrium.png --spp 64 --size 1280x720\n"
    "  rayloom render house.glb -o house.exr --camera 'eye=5,2,5;at=0,1,0' --aov N,Albedo,Z,id\n"
    "  rayloom render cornell --shader ambient_occlusion -o ao.png\n"
    "  rayloom render cornell --pixel 100,80 --spp 256 --json\n";

struct RenderCommand : RenderOptions {
  std::vector<std::string> outputs;
  double exposure_stops = 0;
};

void check_outputs(const RenderCommand& o) {
  if (o.outputs.empty() && !o.pixel) throw UsageError("-o: an output file is needed, .exr or .png");
  for (const std::string& path : o.outputs) {
    if (!has_extension(path, ".exr") && !has_extension(path, ".png")) {
      throw UsageError(fmt::format("-o: '{}' is no file name that ends in .exr or .png", path));
    }
  }
}

/// Views and barycentrics are no light: they are shown as they are.
ToneMap tone_map_of(const shaders::ProgramInfo& program) { return program.lights ? ToneMap::neutral : ToneMap::none; }

void write_outputs(const RenderCommand& o, const Image& image, const shaders::ProgramInfo& program) {
  for (const std::string& path : o.outputs) {
    if (has_extension(path, ".exr")) {
      write_exr(path, image);
    } else {
      const auto stops = static_cast<float>(o.exposure_stops);
      write_png(path, make_preview(image, tone_map_of(program), stops), image.metadata);
    }
  }
}

Json pixel_to_json(const Pixel& pixel, const Image& image) {
  Json channels;
  for (const Channel& channel : image.channels) {
    channels[channel.name] = channel.is_id() ? Json(channel.ids()[0]) : Json(channel.floats()[0]);
  }
  return {{"x", pixel.x}, {"y", pixel.y}, {"channels", channels}};
}

std::string to_text(const RenderCommand& o, const Image& image, const Json& result) {
  std::vector<std::vector<std::string>> rows{
      {"picture", fmt::format("{}x{}, {} samples a pixel", image.width, image.height,
                              result["samples_per_pixel"].get<uint32_t>())},
      {"rays", with_commas(result["rays"].get<uint64_t>())},
      {"time", format_ns(result["render_time_ns"].get<uint64_t>())},
      {"speed", fmt::format("{:.3g} Mrays/s", result["rays_per_second"].get<double>() * 1e-6)}};
  for (const std::string& path : o.outputs) rows.push_back({"file", path});
  if (!o.pixel) return format_table(rows);
  for (const Channel& channel : image.channels) {
    const std::string value =
        channel.is_id() ? std::to_string(channel.ids()[0]) : fmt::format("{}", channel.floats()[0]);
    rows.push_back({channel.name, value});
  }
  return format_table(rows);
}

int run_render(const RenderCommand& o, const CommonOptions& common) {
  apply_render_options(o);
  check_outputs(o);
  for (const std::string& path : o.outputs) check_writable(path);
  check_json_output(common);
  const ThreadLimit threads(static_cast<unsigned>(o.threads));

  const Stopwatch load;
  const scenes::Scene scene = load_scene(o, common);
  const uint64_t load_time_ns = load.ns();
  const Stopwatch set_up;
  shaders::Renderer renderer = make_renderer(scene, o);
  const uint64_t set_up_time_ns = set_up.ns();
  const Stopwatch render;
  const bool complete = render_samples(renderer, o, common, "render");
  if (!complete && renderer.samples() == 0) throw Interrupted();
  Json result = to_json(renderer, render.ns());
  const ExecutionMode mode = renderer.last_dispatch().mode;

  Image image = make_image(renderer, o.aovs);
  image.metadata = picture_metadata(o, renderer.samples());
  write_outputs(o, image, renderer.program());
  result["scene_load_time_ns"] = load_time_ns;
  result["set_up_time_ns"] = set_up_time_ns;
  result["complete"] = complete;
  result["files"] = o.outputs;
  if (o.pixel) result["pixel"] = pixel_to_json(*o.pixel, image);
  Json report = new_report("render");
  report["config"] = to_json(o, mode);
  report["result"] = result;
  print_report(common, report, to_text(o, image, result));
  if (!complete) fmt::print(stderr, "rayloom: interrupted after {} of {} samples\n", renderer.samples(), o.spp);
  return complete ? exit_ok : exit_interrupted;
}

}  // namespace

void add_render_command(CLI::App& app, CommonOptions& common, Action& action) {
  const auto options = std::make_shared<RenderCommand>();
  CLI::App* sub = add_subcommand(app, "render",
                                 "Render a picture. The same scene and options give the same file, byte for byte, for "
                                 "any number of threads, instruction set and mode.",
                                 examples, common);
  add_render_options(*sub, *options);
  sub->add_option("-o,--output", options->outputs,
                  "Where to: .exr with every channel in 32 bits, .png with a tone mapped preview; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  sub->add_option_function<std::string>(
         "--exposure",
         [=](const std::string& text) { options->exposure_stops = parse_real("--exposure", text, -32, 32); },
         "Stops brighter, .png only [0]")
      ->type_name("EV");
  sub->callback([=, &common, &action] { action = [=, &common] { return run_render(*options, common); }; });
}

}  // namespace rayloom::tools
