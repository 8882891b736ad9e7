#include <rayloom/tools/bench/bench_report.h>

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/machine_state.h>
#include <rayloom/tools/exit_code.h>
#include <rayloom/tools/report.h>

#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::bench {

void add_bench_options(CLI::App& app, BenchOptions& options) {
  app.add_option("-o,--output", options.output, "Write tables and charts there: CSV, SVG and one HTML page")
      ->type_name("DIR");
  app.add_flag("--check", options.check, "Exit 1 when a target is missed, and name it");
}

BenchReport::BenchReport(const std::string& bench_name, const std::string& title)
    : name(bench_name), json(tools::new_report("bench." + bench_name)), page(bench_name, title) {
  const MachineState state = machine_state();
  json["machine"] = to_json(state);
  text = to_text(state);
  page.add_text(to_text(state));
}

void BenchReport::add_table(const PageTable& table) {
  text += "\n" + table.title + "\n" + tools::format_table(table.rows);
  page.add_table(table);
}

Json to_json(const Spread& spread) { return {{"low", spread.low}, {"median", spread.median}, {"high", spread.high}}; }

std::string to_text(const Spread& spread, double scale) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", spread.median * scale, spread.low * scale, spread.high * scale);
}

void check_bench_output(const BenchOptions& options, const tools::CommonOptions& common) {
  tools::check_json_output(common);
  if (options.output.empty()) return;
  if (std::filesystem::exists(options.output) && !std::filesystem::is_directory(options.output)) {
    throw InputError(options.output, "", "is a file; --output names a directory");
  }
}

int finish_bench(BenchReport& report, const BenchOptions& options, const tools::CommonOptions& common) {
  report.json["targets"] = report.targets.to_json();
  const std::string targets = report.targets.to_text();
  if (!targets.empty()) report.text += "\n" + targets;
  if (!options.output.empty()) {
    if (!targets.empty()) report.page.add_text(targets);
    const std::vector<std::string> files = report.page.write(options.output);
    report.json["files"] = files;
    if (!common.quiet) fmt::print(stderr, "rayloom: wrote {} files to {}\n", files.size(), options.output);
  }
  tools::print_report(common, report.json, report.text);
  if (!options.check || report.targets.all_met()) return tools::exit_ok;
  for (const Target& target : report.targets.all()) {
    if (!target.met()) fmt::print(stderr, "rayloom: target missed: {}\n", target.name);
  }
  return tools::exit_different;
}

}  // namespace rayloom::bench
