#include <rayloom/tools/bench/machine_state.h>

#include <rayloom/accel/trace.h>
#include <rayloom/base/parallel.h>
#include <rayloom/base/version.h>
#include <rayloom/tools/bench/peer_embree.h>

#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <sched.h>

namespace rayloom::bench {
namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

unsigned usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 ? static_cast<unsigned>(CPU_COUNT(&set)) : 0;
}

}  // namespace

MachineState machine_state() {
  const Version& v = version();
  double load = 0;
  if (getloadavg(&load, 1) != 1) load = -1;
  return {cpu_model(),
          usable_cores(),
          thread_limit(),
          std::string(accel::isa_name(accel::current_isa())),
          v.compiler,
          v.build_type,
          v.sanitizers,
          v.commit,
          v.number,
          embree_version(),
          load};
}

Json to_json(const MachineState& state) {
  return {{"cpu", state.cpu},
          {"cores", state.cores},
          {"threads", state.threads},
          {"isa", state.isa},
          {"compiler", state.compiler},
          {"build_type", state.build_type},
          {"sanitizers", state.sanitizers},
          {"commit", state.commit},
          {"rayloom_version", state.rayloom_version},
          {"embree_version", state.embree_version.empty() ? Json() : Json(state.embree_version)},
          {"load_average", state.load_average}};
}

std::string to_text(const MachineState& state) {
  const std::string embree = state.embree_version.empty() ? "no Embree" : "Embree " + state.embree_version;
  return fmt::format("{}, {} cores, {} threads, {}; {} {}{}; rayloom {} ({}), {}; load {:.2f}\n", state.cpu,
                     state.cores, state.threads, state.isa, state.compiler, state.build_type,
                     state.sanitizers.empty() ? "" : " with " + state.sanitizers, state.rayloom_version, state.commit,
                     embree, state.load_average);
}

}  // namespace rayloom::bench
