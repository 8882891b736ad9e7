#include <rayloom/tools/bench/instructions.h>

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/process.h>

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_ZERO_STATS
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_DUMP_STATS_AT(name) static_cast<void>(name)
#endif

namespace rayloom::bench {
namespace {

constexpr int counted_times = 3;
constexpr const char *trigger = "desc: Trigger: Client Request: ", *totals = "\ntotals: ";

}  // namespace

void count_region(const std::string& name, const std::function<void()>& work) {
  work();
  for (int time = 0; time < counted_times; ++time) {
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    work();
    CALLGRIND_STOP_INSTRUMENTATION;
    CALLGRIND_DUMP_STATS_AT(name.c_str());
  }
}

void add_counted_region(std::map<std::string, uint64_t>& regions, const std::string& output) {
  const size_t name = output.find(trigger), count = output.rfind(totals);
  if (name == std::string::npos || count == std::string::npos) return;
  const size_t begin = name + std::string(trigger).size();
  const std::string region = output.substr(begin, output.find('\n', begin) - begin);
  const uint64_t instructions = std::stoull(output.substr(count + std::string(totals).size()));
  const auto [known, added] = regions.try_emplace(region, instructions);
  if (!added) known->second = std::min(known->second, instructions);
}

CountedRun count_instructions(const std::vector<std::string>& arguments) {
  const TemporaryDirectory scratch;
  std::vector<std::string> command{"-q", "--tool=callgrind", "--instr-atstart=no",
                                   "--callgrind-out-file=" + scratch.file("counts"),
                                   std::filesystem::read_symlink("/proc/self/exe").string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ProcessResult result = run_process("valgrind", command, "", "valgrind");
  if (result.exit_code != 0) {
    throw InputError("valgrind", "", fmt::format("the counted run failed ({}): {}", result.exit_code, result.err));
  }
  CountedRun run{{}, result.out};
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path())) {
    add_counted_region(run.regions, read_whole_file(entry.path().string()));
  }
  if (run.regions.empty()) throw InputError("valgrind", "", "counted nothing; was this built with valgrind's headers?");
  return run;
}

}  // namespace rayloom::bench
