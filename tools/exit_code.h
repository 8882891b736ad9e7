#pragma once

// What the shell sees. Every subcommand answers with one of these and nothing else.

namespace rayloom::tools {

enum ExitCode : int {
  exit_ok = 0,
  exit_different = 1,  ///< compared and found different, or a required bound missed
  exit_usage = 2,
  exit_bad_input = 3,  ///< a file, scene or output the user named is at fault
  exit_internal = 4,   ///< a fault of ours; the message ends with the command that shows it again
  exit_interrupted = 130,
};

}  // namespace rayloom::tools
