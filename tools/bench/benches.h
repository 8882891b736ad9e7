#pragma once

// The subcommands of `rayloom bench`, each in a folder and a library of its own.

#include <rayloom/tools/subcommand.h>

namespace rayloom::bench {

void add_bench_build(CLI::App& bench, tools::CommonOptions& common, tools::Action& action);
void add_bench_traversal(CLI::App& bench, tools::CommonOptions& common, tools::Action& action);
void add_bench_numerics(CLI::App& bench, tools::CommonOptions& common, tools::Action& action);
void add_bench_error(CLI::App& bench, tools::CommonOptions& common, tools::Action& action);

}  // namespace rayloom::bench
