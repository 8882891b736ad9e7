#pragma once

// The frame every subcommand hangs in: one CLI11 application, help that starts with examples, and one place where
// exceptions become exit codes.

#include <rayloom/tools/common_options.h>
#include <rayloom/tools/exit_code.h>

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rayloom::tools {

/// What the command line asked for: set by the chosen subcommand's callback, run once parsing is over.
using Action = std::function<int()>;

/// Adds subcommand `name`. `examples`: one command a line, shown before the usage.
CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& examples, CommonOptions& common);

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

}  // namespace rayloom::tools
