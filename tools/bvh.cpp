// rayloom bvh SCENE: what the builder made of each mesh and of the instances.

#include <rayloom/accel/build.h>
#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>
#include <rayloom/scenes/scene.h>
#include <rayloom/tools/cli.h>
#include <rayloom/tools/cli_values.h>
#include <rayloom/tools/report.h>
#include <rayloom/tools/scene_structures.h>

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr const char* examples =
    "  rayloom bvh atrium                         a table on standard output\n"
    "  rayloom bvh house.glb --json=bvh.json      and every structure in a file\n"
    "  rayloom bvh atrium --prefer fast_build     as PREFER_FAST_BUILD asks\n"
    "  rayloom bvh atrium --builder binned_sah    by this builder, whatever the flags\n"
    "  rayloom bvh forest --rebraid               instances that overlap are entered at several nodes\n";

constexpr size_t table_rows = 20;

struct BvhOptions {
  std::string scene;
  uint64_t threads = 0;
  accel::BuildSettings settings{accel::build_flag::none};
};

double bytes_per_primitive(const accel::StructureInfo& info) {
  return info.primitives ? static_cast<double>(info.bytes) / static_cast<double>(info.primitives) : 0;
}

std::string kind_of(const accel::StructureInfo& info) {
  return info.top_level ? "top level" : info.procedural ? "procedural" : "triangles";
}

Json to_json(const BuiltStructure& built) {
  const accel::StructureInfo& info = built.info;
  return {{"name", built.name},
          {"kind", kind_of(info)},
          {"builder", accel::builder_name(info.builder)},
          {"primitives", info.primitives},
          {"active_primitives", info.active_primitives},
          {"geometries", info.geometries},
          {"lazy_parts", info.parts},
          {"nodes", info.nodes},
          {"leaves", info.leaves},
          {"depth_nodes", info.depth},
          {"sah_cost", info.sah_cost},
          {"memory_bytes", info.bytes},
          {"reserved_bytes", built.reserved_bytes},
          {"bytes_per_primitive", bytes_per_primitive(info)},
          {"build_time_ns", built.build_time_ns},
          {"bounds_min", info.bounds_min},
          {"bounds_max", info.bounds_max}};
}

std::vector<std::string> table_row(const BuiltStructure& built) {
  const accel::StructureInfo& info = built.info;
  return {built.name,
          kind_of(info),
          accel::builder_name(info.builder),
          with_commas(info.primitives),
          with_commas(info.nodes),
          with_commas(info.leaves),
          std::to_string(info.depth),
          fmt::format("{:.2f}", info.sah_cost),
          format_bytes(info.bytes),
          fmt::format("{:.1f}", bytes_per_primitive(info)),
          format_ns(built.build_time_ns)};
}

/// Sums over the structures that can be summed.
BuiltStructure total(const std::vector<BuiltStructure>& structures) {
  BuiltStructure sum{"total", {}, 0, 0};
  for (const BuiltStructure& built : structures) {
    sum.info.bytes += built.info.bytes;
    sum.info.nodes += built.info.nodes;
    sum.info.leaves += built.info.leaves;
    if (!built.info.top_level) sum.info.primitives += built.info.primitives;
    sum.reserved_bytes += built.reserved_bytes;
    sum.build_time_ns += built.build_time_ns;
  }
  return sum;
}

std::string to_text(std::vector<BuiltStructure> structures) {
  const BuiltStructure sum = total(structures);
  std::stable_sort(structures.begin(), structures.end() - 1,
                   [](const auto& a, const auto& b) { return a.info.bytes > b.info.bytes; });
  std::vector<std::vector<std::string>> rows{{"structure", "kind", "builder", "primitives", "nodes", "leaves", "depth",
                                              "SAH", "memory", "bytes/prim", "build"}};
  rows.push_back(table_row(structures.back()));
  structures.pop_back();
  for (size_t i = 0; i < std::min(structures.size(), table_rows); ++i) rows.push_back(table_row(structures[i]));
  std::vector<std::string> last = table_row(sum);
  last[1] = last[2] = last[6] = last[7] = "";
  rows.push_back(last);
  std::string text = format_table(rows);
  if (structures.size() > table_rows) {
    text += fmt::format("{} smaller structures are left out here; --json lists them all.\n",
                        structures.size() - table_rows);
  }
  return text;
}

uint32_t parse_build_preference(const std::string& name) {
  if (name == "fast_trace") return accel::build_flag::prefer_fast_trace;
  if (name == "fast_build") return accel::build_flag::prefer_fast_build;
  if (name == "minimize_memory") return accel::build_flag::minimize_memory;
  throw UsageError(fmt::format("--prefer: '{}' is not one of fast_trace fast_build minimize_memory", name));
}

accel::Builder parse_builder_option(const std::string& name) {
  if (const auto builder = accel::parse_builder(name)) return *builder;
  std::string known = accel::builder_name(accel::Builder::automatic);
  for (const accel::Builder builder : accel::all_builders()) known += std::string(" ") + accel::builder_name(builder);
  throw UsageError(fmt::format("--builder: '{}' is not one of {}", name, known));
}

int run_bvh(const BvhOptions& options, const CommonOptions& common) {
  check_json_output(common);
  const ThreadLimit threads(static_cast<unsigned>(options.threads));
  const scenes::Scene scene = scenes::load_scene(options.scene);
  const SceneStructures built(scene, options.settings);

  Json report = new_report("bvh");
  report["scene"] = options.scene;
  report["threads"] = thread_limit();
  report["build_flags"] = options.settings.flags;
  report["builder"] = accel::builder_name(options.settings.builder);
  report["rebraid"] = options.settings.rebraid;
  for (const BuiltStructure& structure : built.structures()) report["structures"].push_back(to_json(structure));
  const BuiltStructure sum = total(built.structures());
  report["total"] = {{"primitives", sum.info.primitives},
                     {"nodes", sum.info.nodes},
                     {"leaves", sum.info.leaves},
                     {"memory_bytes", sum.info.bytes},
                     {"reserved_bytes", sum.reserved_bytes},
                     {"build_time_ns", sum.build_time_ns}};
  print_report(common, report, to_text(built.structures()));
  return exit_ok;
}

}  // namespace

void add_bvh_command(CLI::App& app, CommonOptions& common, Action& action) {
  const auto options = std::make_shared<BvhOptions>();
  CLI::App* sub =
      add_subcommand(app, "bvh",
                     "Build a scene's acceleration structures and describe them. SAH is the expected number "
                     "of node and leaf visits of a random ray that hits the root box.",
                     examples, common);
  sub->add_option("SCENE", options->scene, "A glTF file or a procedural scene")->required();
  sub->add_option_function<std::string>(
         "--prefer", [=](const std::string& name) { options->settings.flags |= parse_build_preference(name); },
         "Build flag: fast_trace, fast_build or minimize_memory")
      ->type_name("NAME");
  sub->add_option_function<std::string>(
         "--builder", [=](const std::string& name) { options->settings.builder = parse_builder_option(name); },
         "Builder, whatever the flags prefer; an unknown name lists them all")
      ->type_name("NAME");
  sub->add_flag("--rebraid", options->settings.rebraid,
                "Open instances that overlap others into several leaves of the top level");
  sub->add_flag_callback(
      "--lazy", [=] { options->settings.flags |= accel::build_flag::lazy; },
      "Build bottom levels of triangles part by part when rays come to them: none is built here");
  add_count(*sub, "--threads", options->threads, 0, 1024, "Threads, 0 for one a core");
  sub->callback([=, &common, &action] { action = [=, &common] { return run_bvh(*options, common); }; });
}

}  // namespace rayloom::tools
