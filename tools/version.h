#pragma once

#include <string>

namespace rayloom::tools {

/// What --version prints, one fact a line: version, commit, compiler, build type, sanitizers, floating-point flags, and
/// the instruction sets this machine can use.
std::string version_report();

}  // namespace rayloom::tools
