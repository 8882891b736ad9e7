#pragma once

#include <string>

namespace rayloom::tools {

/// What every subcommand shares.
struct CommonOptions {
  bool quiet = false;   ///< nothing on stderr but errors
  std::string json;     ///< empty: no JSON; "-": standard output; else a file
  std::string command;  ///< the whole command line, quoted for a shell
  bool json_on_stdout() const { return json == "-"; }
};

}  // namespace rayloom::tools
