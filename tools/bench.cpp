// rayloom bench NAME: measurements. Each lives in tools/bench/NAME.

#include <rayloom/tools/bench/benches.h>
#include <rayloom/tools/cli.h>

#include <CLI/CLI.hpp>

namespace rayloom::tools {

void add_bench_command(CLI::App& app, CommonOptions& common, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", "Measure speed and error, beside Embree where it is installed.");
  bench->footer(
      "  rayloom bench traversal atrium --against embree    rays a second\n"
      "  rayloom bench build atrium -o out                  what each builder costs and gives\n");
  bench->require_subcommand(1);
  bench::add_bench_build(*bench, common, action);
  bench::add_bench_traversal(*bench, common, action);
  bench::add_bench_numerics(*bench, common, action);
  bench::add_bench_error(*bench, common, action);
}

}  // namespace rayloom::tools
