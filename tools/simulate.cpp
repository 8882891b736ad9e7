// rayloom simulate SCENE -o DIR: the same picture on the simulated GPU, and what it cost. Read on in
// hwmodel/replay.cpp.

#include <rayloom/base/error.h>
#include <rayloom/base/output_file.h>
#include <rayloom/base/parallel.h>
#include <rayloom/hwmodel/report.h>
#include <rayloom/tools/channels.h>
#include <rayloom/tools/cli.h>
#include <rayloom/tools/image_compare.h>
#include <rayloom/tools/image_io.h>
#include <rayloom/tools/interrupt.h>
#include <rayloom/tools/preview.h>
#include <rayloom/tools/rendering.h>
#include <rayloom/tools/simulated_picture.h>

#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr const char* examples =
    "  rayloom simulate cornell -o out --size 128x72 --spp 1\n"
    "  rayloom simulate atrium -o out --size 256x144 --spp 1 --set rt.box_latency=20 --set sm.count=34\n"
    "  rayloom simulate atrium --print-config          the parameters, their sources and how sure they are\n";

struct SimulateCommand : RenderOptions {
  std::string directory;
  std::string gpu;
  std::vector<std::string> settings;
  bool print_config = false;

  std::string file(const char* name) const { return (std::filesystem::path(directory) / name).string(); }
};

/// The preset with the user's settings. Their errors name the option.
hwmodel::GpuPreset configure(const SimulateCommand& o) {
  hwmodel::GpuPreset preset;
  try {
    preset = hwmodel::make_preset(o.gpu);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("--gpu: {}", error.what()));
  }
  try {
    for (const std::string& setting : o.settings) hwmodel::set_parameter(preset, setting);
    hwmodel::check_config(preset.config);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("--set: {}", error.what()));
  }
  return preset;
}

/// Makes the directory, and proves that files can be written there before any work is done.
void prepare_directory(const SimulateCommand& o) {
  std::error_code error;
  std::filesystem::create_directories(o.directory, error);
  if (error) throw InputError(o.directory, "", "cannot be made a directory: " + error.message());
  if (!std::filesystem::is_directory(o.directory)) throw InputError(o.directory, "", "is no directory");
  check_writable(o.file("picture.exr"));
}

struct Outcome {
  hwmodel::GpuStats stats;
  Image simulated, cycles;
  Comparison comparison;
  Json native;
};

Outcome simulate(const SimulateCommand& o, const hwmodel::GpuPreset& preset, const CommonOptions& common) {
  const scenes::Scene scene = load_scene(o, common);
  Outcome outcome;
  shaders::Renderer native = make_renderer(scene, o);
  const Stopwatch watch;
  if (!render_samples(native, o, common, "native")) throw Interrupted();
  outcome.native = to_json(native, watch.ns());
  const Image reference = make_image(native, o.aovs);

  SimulatedPicture simulation = simulate_picture(scene, o, preset.config, common);
  outcome.stats = std::move(simulation.stats);
  outcome.simulated = std::move(simulation.picture);
  outcome.cycles = std::move(simulation.cycles);
  outcome.comparison = compare_images(outcome.simulated, "the simulated picture", reference, "the native one");
  outcome.simulated.metadata = picture_metadata(o, native.samples());
  outcome.cycles.metadata = outcome.simulated.metadata;
  return outcome;
}

std::string verdict_text(const Comparison& comparison) {
  if (comparison.bits_equal) return "The simulated picture and the native one are equal bit for bit.\n";
  return fmt::format("The simulated picture DIFFERS from the native one in {} of {} samples, by at most {:.6g}.\n",
                     comparison.overall.different, comparison.overall.samples, comparison.overall.largest);
}

Json make_report(const SimulateCommand& o, const hwmodel::GpuPreset& preset, const Outcome& outcome) {
  Json report = new_report("simulate");
  report["config"] = to_json(o, ExecutionMode::warp);
  report["picture_equals_native"] = outcome.comparison.bits_equal;
  report["different_samples"] = outcome.comparison.overall.different;
  report["native"] = outcome.native;
  report["simulation"] = Json::parse(hwmodel::report_json(outcome.stats, preset));
  return report;
}

void write_files(const SimulateCommand& o, const Outcome& outcome, const Json& report, const std::string& text) {
  const std::vector<float>& cycles = outcome.cycles.channels.front().floats();
  const float top = quantile(cycles, 0.995);
  write_exr(o.file("picture.exr"), outcome.simulated);
  write_exr(o.file("cycles.exr"), outcome.cycles);
  write_png(o.file("cycles.png"), make_heat_map(outcome.cycles.width, outcome.cycles.height, cycles, top),
            {{"Description", fmt::format("clocks a pixel, black 0, white {} and above", top)}});
  write_json(o.file("stats.json"), report);
  write_file(o.file("stats.txt"), text);
  write_file(o.file("stats.csv"), hwmodel::report_csv(outcome.stats));
}

int run_simulate(const SimulateCommand& o, const CommonOptions& common) {
  apply_render_options(o);
  const hwmodel::GpuPreset preset = configure(o);
  if (o.print_config) {
    print_report(common, Json::parse(hwmodel::parameter_json(preset)), hwmodel::parameter_table(preset));
    return exit_ok;
  }
  if (o.directory.empty()) throw UsageError("-o: a directory for the results is needed");
  prepare_directory(o);
  check_json_output(common);
  const ThreadLimit threads(static_cast<unsigned>(o.threads));

  Outcome outcome;
  try {
    outcome = simulate(o, preset, common);
  } catch (const hwmodel::ReplayMismatch& mismatch) {
    fmt::print(stderr, "rayloom: the simulated hits differ from the captured ones: {}\n", mismatch.what());
    return exit_different;
  }
  const std::string verdict = verdict_text(outcome.comparison);
  const std::string text = hwmodel::report_text(outcome.stats) + verdict;
  const Json report = make_report(o, preset, outcome);
  write_files(o, outcome, report, text);
  print_report(common, report, text);
  return outcome.comparison.bits_equal ? exit_ok : exit_different;
}

}  // namespace

void add_simulate_command(CLI::App& app, CommonOptions& common, Action& action) {
  const auto options = std::make_shared<SimulateCommand>();
  options->gpu = hwmodel::preset_names().front();
  CLI::App* sub =
      add_subcommand(app, "simulate",
                     "Render on the simulated GPU: its picture, clocks a pixel, statistics. Exit code 1 if the picture "
                     "differs from the\n"
                     "native one of the same options in a single bit. --mode is that of the native rendering.",
                     examples, common);
  add_render_options(*sub, *options);
  sub->add_option("-o,--output", options->directory,
                  "Directory for picture.exr, cycles.exr, cycles.png, stats.json, stats.txt, stats.csv")
      ->type_name("DIR");
  sub->add_option("--gpu", options->gpu, fmt::format("Preset: {}", fmt::join(hwmodel::preset_names(), " ")))
      ->type_name("NAME")
      ->capture_default_str();
  sub->add_option("--set", options->settings, "Change a parameter of the preset; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  sub->add_flag("--print-config", options->print_config, "Print the configuration and where its values come from");
  sub->callback([=, &common, &action] { action = [=, &common] { return run_simulate(*options, common); }; });
}

}  // namespace rayloom::tools
