#pragma once

// What every bench shares: options of the command line, and how its results leave the program.

#include <rayloom/base/json.h>
#include <rayloom/tools/bench/measure.h>
#include <rayloom/tools/bench/page.h>
#include <rayloom/tools/bench/targets.h>
#include <rayloom/tools/common_options.h>

#include <string>

namespace CLI {
class App;
}

namespace rayloom::bench {

struct BenchOptions {
  std::string output;  ///< directory for the page; empty: none
  bool check = false;  ///< a missed target is exit code 1
};

/// Adds --output DIR and --check.
void add_bench_options(CLI::App& app, BenchOptions& options);

/// Results so far. `json` begins as a report of schema "rayloom.bench.<name>" with the machine's state.
struct BenchReport {
  BenchReport(const std::string& name, const std::string& title);

  std::string name;
  Json json;
  std::string text;  ///< tables for standard output, after the machine's state
  Page page;
  Targets targets;

  /// A table in all three: `text`, `page` and, under `table.name`, nothing else of `json`.
  void add_table(const PageTable& table);
};

Json to_json(const Spread& spread);
/// "3.21 (3.10 to 3.30)", after multiplying by `scale`.
std::string to_text(const Spread& spread, double scale = 1);

/// InputError before the work begins when --json or --output cannot be written.
void check_bench_output(const BenchOptions& options, const tools::CommonOptions& common);

/// Prints text or JSON, writes the page, names missed targets on standard error. The command's exit code.
int finish_bench(BenchReport& report, const BenchOptions& options, const tools::CommonOptions& common);

}  // namespace rayloom::bench
