// rayloom bench build [SCENES]: what every builder costs and gives, beside Embree's three.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/benches.h>
#include <rayloom/tools/bench/build/build_report.h>
#include <rayloom/tools/bench/scene_options.h>
#include <rayloom/tools/cli_values.h>

#include <algorithm>

#include <CLI/CLI.hpp>

namespace rayloom::bench {
namespace {

constexpr const char* examples =
    "  rayloom bench build atrium                 a table on standard output\n"
    "  rayloom bench build --check                atrium, dragon and terrain; exit 1 below a target\n"
    "  rayloom bench build terrain -o out         and the graph of rays a second against rays a build\n";

int run_build(BuildOptions options, const tools::CommonOptions& common) {
  check_bench_output(options, common);
  if (options.against_embree && embree_version().empty()) options.against_embree = false;
  options.progress = !common.quiet;
  BenchReport report("build", "Builders: what a build costs and what the tree gives");
  std::vector<std::string> missing;
  const auto scenes = choose_scenes(options.scenes, {"atrium", "dragon", "terrain"}, options.scenes_directory, missing);
  std::vector<BuildRow> rows;
  for (const std::string& scene : scenes) {
    for (BuildRow& row : run_builds(scene, options)) rows.push_back(std::move(row));
  }
  report.json["missing_scenes"] = missing;
  report.json["settings"] = {{"image_side_pixels", options.size}, {"repetitions", options.repetitions}};
  add_builds(report, rows);
  return finish_bench(report, options, common);
}

}  // namespace

void add_bench_build(CLI::App& bench, tools::CommonOptions& common, tools::Action& action) {
  const auto options = std::make_shared<BuildOptions>();
  CLI::App* sub = tools::add_subcommand(
      bench, "build",
      "Build with every builder of ours and, where it is installed, Embree's qualities; then trace bounce rays with "
      "each tree. One thread is always measured: the graph is made from it.",
      examples, common);
  add_scene_options(*sub, options->scenes, options->scenes_directory, "atrium dragon terrain");
  sub->add_option_function<std::string>(
         "--against", [=](const std::string& text) { options->against_embree = parse_peer(text, true); },
         "embree or none [embree, where there is one]")
      ->type_name("PEER");
  sub->add_option_function<std::string>(
         "--threads",
         [=](const std::string& text) {
           options->threads = parse_threads(text);
           if (std::count(options->threads.begin(), options->threads.end(), 1u) == 0) {
             options->threads.insert(options->threads.begin(), 1u);
           }
         },
         "Thread counts of the builds, 1 always among them [1,2]")
      ->type_name("N,...");
  tools::add_count(*sub, "--repetitions", options->repetitions, 1, 1000, "Timed runs of each, after a warm-up");
  tools::add_count(*sub, "--size", options->size, 1, 4096, "Side of the picture the rays come from, in pixels");
  add_bench_options(*sub, *options);
  sub->callback([=, &common, &action] { action = [=, &common] { return run_build(*options, common); }; });
}

}  // namespace rayloom::bench
