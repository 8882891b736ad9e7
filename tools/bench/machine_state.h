#pragma once

// What a figure was measured on: printed with every bench and part of its JSON.

#include <rayloom/base/json.h>

#include <string>
#include <vector>

namespace rayloom::bench {

struct MachineState {
  std::string cpu;       ///< model name as the system gives it
  unsigned cores = 0;    ///< this process may run on
  unsigned threads = 0;  ///< base/parallel.h uses now
  std::string isa;       ///< of the kernels in use: "avx512"
  std::string compiler, build_type, sanitizers, commit, rayloom_version;
  std::string embree_version;  ///< "" when built without
  double load_average = 0;     ///< over the last minute, when read
};

MachineState machine_state();
Json to_json(const MachineState& state);
/// One line.
std::string to_text(const MachineState& state);

}  // namespace rayloom::bench
