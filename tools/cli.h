#pragma once

// The frame every subcommand hangs in: one CLI11 application, help that starts with examples, and one place where
// exceptions become exit codes.

#include <rayloom/tools/exit_code.h>
#include <rayloom/tools/subcommand.h>

#include <string>
#include <vector>

namespace rayloom::tools {

/// Parses, runs the chosen action and turns every exception into a message on stderr and an exit code.
int run_command_line(int argc, const char* const* argv);

/// `--json` alone means standard output, so that a positional argument after it stays one.
std::vector<std::string> normalise_arguments(int argc, const char* const* argv);

/// Quotes a word for a POSIX shell if it needs quoting.
std::string shell_quote(const std::string& word);

void add_render_command(CLI::App& app, CommonOptions& common, Action& action);
void add_simulate_command(CLI::App& app, CommonOptions& common, Action& action);
void add_diff_command(CLI::App& app, CommonOptions& common, Action& action);
void add_bvh_command(CLI::App& app, CommonOptions& common, Action& action);
void add_scene_command(CLI::App& app, CommonOptions& common, Action& action);
void add_bench_command(CLI::App& app, CommonOptions& common, Action& action);

}  // namespace rayloom::tools
