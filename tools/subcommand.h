#pragma once

// How a subcommand is made, whatever library it lives in.

#include <rayloom/tools/common_options.h>

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace rayloom::tools {

/// What the command line asked for: set by the chosen subcommand's callback, run once parsing is over.
using Action = std::function<int()>;

/// Adds subcommand `name` to `app`. `examples`: one command a line, shown before the usage.
CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& examples, CommonOptions& common);

}  // namespace rayloom::tools
