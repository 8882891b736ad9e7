// rayloom bench NAME: measurements. Each lives in tools/bench/NAME.

#include <rayloom/tools/bench/benches.h>
#include <rayloom/tools/cli.h>

#include <CLI/CLI.hpp>

namespace rayloom::tools {

void add_bench_command(CLI::App& app, [[maybe_unused]] CommonOptions& common, [[maybe_unused]] Action& action) {
  CLI::App* bench = app.add_subcommand("bench", "Measure speed and error, beside Embree where it is installed.");
  bench->footer(
      "  rayloom bench traversal atrium --against embree    rays a second\n"
      "  rayloom bench build atrium -o out                  what each builder costs and gives\n");
  bench->require_subcommand(1);
#ifdef RAYLOOM_BENCH_BUILD
  bench::add_bench_build(*bench, common, action);
#endif
#ifdef RAYLOOM_BENCH_TRAVERSAL
  bench::add_bench_traversal(*bench, common, action);
#endif
#ifdef RAYLOOM_BENCH_NUMERICS
  bench::add_bench_numerics(*bench, common, action);
#endif
#ifdef RAYLOOM_BENCH_ERROR
  bench::add_bench_error(*bench, common, action);
#endif
}

}  // namespace rayloom::tools
