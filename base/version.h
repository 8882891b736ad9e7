#pragma once

#include <string>

namespace rayloom {

/// What this library was built from and how; for --version and reports.
struct Version {
  const char* number;      ///< "0.1.0"
  const char* compiler;    ///< "GNU 12.2.0"
  const char* build_type;  ///< "Release"
  const char* sanitizers;  ///< "address,undefined", or ""
  const char* commit;      ///< of the source tree when it was configured, or "" outside a checkout
};

const Version& version();

/// "0.1.0 (1a2b3c4d5e6f, GNU 12.2.0, Release)"
std::string version_text();

}  // namespace rayloom
