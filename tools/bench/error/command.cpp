// rayloom bench error [SCENES]: error of pictures against samples and seconds. Read on in experiment.cpp and
// series.cpp.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/benches.h>
#include <rayloom/tools/bench/error/error_report.h>
#include <rayloom/tools/bench/error/experiment.h>
#include <rayloom/tools/bench/error/lamp_scenes.h>
#include <rayloom/tools/cli_values.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::bench {
namespace {

constexpr const char* examples =
    "  rayloom bench error cornell -o out --reference cornell.exr   tables, charts, a page; keeps the reference\n"
    "  rayloom bench error atrium --sampler owen-sobol --estimator mis,light,bsdf --spp 1,4,16,64\n"
    "  rayloom bench error small-lamps large-lamps --sampler owen-sobol --check\n";

constexpr uint64_t max_spp = 1 << 16, max_reference_spp = 1 << 26, max_seeds = 1024, max_path_bounces = 1000;
constexpr uint64_t reference_factor = 100;

struct ErrorCommand : BenchOptions {
  std::vector<std::string> scenes{"cornell", "spheres", "atrium"};
  std::vector<uint32_t> spp{1, 4, 16, 64, 256};
  std::vector<std::string> samplers{std::begin(shaders::sampler_names), std::end(shaders::sampler_names)};
  std::vector<std::string> estimators{"mis"};
  uint64_t seeds = 8, reference_spp = 0, max_bounces = 8;
  tools::Size size{64, 36};
  std::string reference_file;
};

std::vector<uint32_t> parse_spp(const std::string& text) {
  std::vector<uint32_t> counts;
  for (const std::string& part : tools::parse_names("--spp", text)) {
    const auto count = static_cast<uint32_t>(tools::parse_count("--spp", part, 1, max_spp));
    if (!counts.empty() && count <= counts.back()) throw UsageError("--spp: sample counts must rise");
    counts.push_back(count);
  }
  if (counts.size() < 2) throw UsageError("--spp: a slope needs two sample counts or more");
  return counts;
}

ErrorSettings make_settings(const ErrorCommand& o) {
  ErrorSettings settings;
  settings.spp = o.spp;
  settings.seeds = static_cast<uint32_t>(o.seeds);
  settings.width = o.size.width, settings.height = o.size.height;
  settings.max_bounces = static_cast<uint32_t>(o.max_bounces);
  settings.configurations = make_configurations(o.samplers, o.estimators);
  const uint64_t least = reference_factor * o.spp.back();
  settings.reference_spp = o.reference_spp ? o.reference_spp : least;
  if (settings.reference_spp < least) {
    throw UsageError(fmt::format("--reference-spp: a reference needs at least {} times the most samples, {}",
                                 reference_factor, least));
  }
  return settings;
}

Json to_json(const ErrorSettings& settings) {
  return {{"spp", settings.spp},
          {"seeds", settings.seeds},
          {"reference_spp", settings.reference_spp},
          {"width", settings.width},
          {"height", settings.height},
          {"max_bounces", settings.max_bounces},
          {"reference_parts", reference_parts}};
}

int run_bench_error(const ErrorCommand& o, const tools::CommonOptions& common) {
  const ErrorSettings settings = make_settings(o);
  check_bench_output(o, common);
  ReferenceFile references(o.reference_file, settings.width, settings.height);
  BenchReport report("error", "Image error against samples and seconds");
  report.json["config"] = to_json(settings);
  std::vector<SceneErrors> results;
  for (const std::string& name : o.scenes) {
    const scenes::Scene scene = load_error_scene(name);
    results.push_back(measure_scene(scene, settings, references, !common.quiet));
  }
  add_results(report, results);
  return finish_bench(report, o, common);
}

/// An option whose text `parse` stores.
template <class Parse>
void add_parsed(CLI::App& sub, const char* name, const char* type, const std::string& description, Parse parse) {
  sub.add_option_function<std::string>(name, parse, description)->type_name(type);
}

void add_error_options(CLI::App& sub, ErrorCommand& o) {
  sub.add_option("SCENES", o.scenes,
                 "glTF files, procedural scenes, small-lamps, large-lamps [cornell spheres atrium]");
  add_parsed(sub, "--spp", "N,N,...", "Rising sample counts a pixel [1,4,16,64,256]",
             [&o](const std::string& text) { o.spp = parse_spp(text); });
  tools::add_count(sub, "--seeds", o.seeds, 2, max_seeds, "Independent pictures at each sample count");
  tools::add_count(sub, "--reference-spp", o.reference_spp, 0, max_reference_spp,
                   "Samples a pixel of the reference, 0 for 100 times the most samples");
  sub.add_option("--reference", o.reference_file, "Keep references there, and use those that are there (.exr)")
      ->type_name("FILE");
  add_parsed(sub, "--size", "WxH", "Picture size in pixels [64x36]",
             [&o](const std::string& text) { o.size = tools::parse_size("--size", text); });
  add_parsed(sub, "--sampler", "LIST", "Random numbers: owen-sobol, independent [both]",
             [&o](const std::string& text) { o.samplers = tools::parse_names("--sampler", text); });
  add_parsed(sub, "--estimator", "LIST", "Direct light by: mis, light (samples), bsdf (samples) [mis]",
             [&o](const std::string& text) { o.estimators = tools::parse_names("--estimator", text); });
  tools::add_count(sub, "--max-bounces", o.max_bounces, 0, max_path_bounces, "Scatterings a path may have");
  add_bench_options(sub, o);
}

}  // namespace

void add_bench_error(CLI::App& bench, tools::CommonOptions& common, tools::Action& action) {
  const auto options = std::make_shared<ErrorCommand>();
  CLI::App* sub = tools::add_subcommand(bench, "error",
                                        "Render at rising sample counts with independent seeds and measure the error "
                                        "against a reference: relMSE, MSE, FLIP, slopes, times to errors.",
                                        examples, common);
  add_error_options(*sub, *options);
  sub->callback([=, &common, &action] { action = [=, &common] { return run_bench_error(*options, common); }; });
}

}  // namespace rayloom::bench
