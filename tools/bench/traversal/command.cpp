// rayloom bench traversal [SCENES]: rays a second of our kernels, beside Embree's.

#include <rayloom/accel/trace.h>
#include <rayloom/base/error.h>
#include <rayloom/tools/bench/benches.h>
#include <rayloom/tools/bench/scene_options.h>
#include <rayloom/tools/bench/traversal/features.h>
#include <rayloom/tools/bench/traversal/scene_run.h>
#include <rayloom/tools/cli_values.h>
#include <rayloom/tools/exit_code.h>

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::bench {
namespace {

constexpr const char* examples =
    "  rayloom bench traversal atrium --against embree             ratios to Embree HIGH and robust\n"
    "  rayloom bench traversal --against embree --check            every scene there is; exit 1 below a target\n"
    "  rayloom bench traversal dragon --scenes-dir scenes --threads 1 --isa avx2\n"
    "  rayloom bench traversal atrium --against embree -o out      CSV and an HTML page\n"
    "  rayloom bench traversal atrium --features                   what each feature costs\n";

const std::vector<std::string> usual_scenes{"atrium", "dragon", "terrain", "gallery", "forest"};

void select_isa(const TraversalOptions& options) {
  if (!options.avx2) return;
  if (!accel::isa_supported(accel::Isa::avx2)) throw InputError("--isa: this CPU has no avx2");
  accel::set_isa(accel::Isa::avx2);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// The parts that a counting parent starts under callgrind; nobody else does.
enum class Child { none, rays, features };

FeatureOptions feature_options(const TraversalOptions& options) {
  return {options.scenes.empty() ? "atrium" : options.scenes.front(), options.scenes_directory};
}

int run_child(Child child, const TraversalOptions& options) {
  if (child == Child::rays) {
    count_scene(options);
  } else {
    FeatureOptions features = feature_options(options);
    features.size = options.size;
    count_features(features);
  }
  return tools::exit_ok;
}

int run_features(const TraversalOptions& options, const tools::CommonOptions& common) {
  BenchReport report("traversal", "Traversal: what features cost");
  FeatureOptions features = feature_options(options);
  features.size = std::min(options.size, features.size);
  add_features(report, features);
  return finish_bench(report, options, common);
}

int run_traversal(TraversalOptions options, const tools::CommonOptions& common) {
  if (options.against_embree && embree_version().empty()) make_embree({}, {});  // says how to get it
  options.progress = !common.quiet;
  BenchReport report("traversal", "Traversal: rays a second");
  SceneResult all;
  std::vector<std::string> missing;
  for (const std::string& name : choose_scenes(options.scenes, usual_scenes, options.scenes_directory, missing)) {
    const SceneResult result = run_scene(name, options);
    append(all.rows, result.rows);
    append(all.memory, result.memory);
    append(all.breakdowns, result.breakdowns);
  }
  report.json["missing_scenes"] = missing;
  report.json["settings"] = {{"image_side_pixels", options.size},
                             {"batch_rays", options.batch},
                             {"repetitions", options.repetitions},
                             {"against", options.against_embree ? Json("embree") : Json()}};
  add_rows(report, all.rows);
  add_breakdowns(report, all.breakdowns);
  add_memory(report, all.memory);
  add_targets(report.targets, all.rows, all.memory);
  return finish_bench(report, options, common);
}

bool parse_isa(const std::string& text) {
  if (text != "avx2" && text != "fastest") throw UsageError(fmt::format("--isa: '{}' is not avx2 or fastest", text));
  return text == "avx2";
}

}  // namespace

void add_bench_traversal(CLI::App& bench, tools::CommonOptions& common, tools::Action& action) {
  const auto options = std::make_shared<TraversalOptions>();
  CLI::App* sub = tools::add_subcommand(bench, "traversal",
                                        "Rays a second for camera rays, bounces, ambient occlusion and shadows, in "
                                        "batches and one at a time. With a peer, "
                                        "hits are compared and every difference is judged in rational numbers.",
                                        examples, common);
  add_scene_options(*sub, options->scenes, options->scenes_directory, "atrium dragon terrain gallery forest");
  sub->add_option_function<std::string>(
         "--against", [=](const std::string& text) { options->against_embree = parse_peer(text, false); },
         "A peer to race in the same run: embree")
      ->type_name("PEER");
  sub->add_option_function<std::string>(
         "--threads", [=](const std::string& text) { options->threads = parse_threads(text); },
         "Thread counts, one after another [1,2]")
      ->type_name("N,...");
  sub->add_option_function<std::string>(
         "--isa", [=](const std::string& text) { options->avx2 = parse_isa(text); },
         "avx2: us and the peer without AVX-512 [fastest]")
      ->type_name("NAME");
  tools::add_count(*sub, "--repetitions", options->repetitions, 1, 1000, "Timed runs of each, after a warm-up");
  tools::add_count(*sub, "--size", options->size, 1, 4096, "Side of the picture in pixels");
  tools::add_count(*sub, "--batch", options->batch, 1, 1 << 24, "Rays in a call of the batch interface");
  sub->add_flag_callback(
      "--two-level", [=] { options->largest_flat = 0; },
      fmt::format("Keep instances in every scene [those of over {} million triangles]", flatten_limit / 1000000));
  add_bench_options(*sub, *options);
  sub->add_flag("--instructions", options->instructions, "Count instructions a ray, too, with valgrind (AVX2)");
  const auto features = std::make_shared<bool>(false);
  sub->add_flag("--features", *features, "Instead: instructions that each feature costs, used and not, in one scene");
  const auto child = std::make_shared<Child>(Child::none);
  sub->add_flag_callback("--count-rays", [=] { *child = Child::rays; })->group("");
  sub->add_flag_callback("--count-features", [=] { *child = Child::features; })->group("");
  sub->callback([=, &common, &action] {
    action = [=, &common]() -> int {
      check_bench_output(*options, common);
      select_isa(*options);
      if (*child != Child::none) return run_child(*child, *options);
      return *features ? run_features(*options, common) : run_traversal(*options, common);
    };
  });
}

}  // namespace rayloom::bench
