#pragma once

// Instructions executed, counted by callgrind: a figure that no other load on the machine changes. A process counts
// itself by running its own program again under valgrind with other arguments; there, count_region() marks what counts.

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace rayloom::bench {

/// In the child: runs `work` once as a warm-up and three times counted under `name` (no new line in it); the smallest
/// count is kept, since the heap's housekeeping is in the others. Without valgrind it only runs.
void count_region(const std::string& name, const std::function<void()>& work);

struct CountedRun {
  std::map<std::string, uint64_t> regions;  ///< instructions by name
  std::string out;                          ///< what the child printed
};

/// In the parent: runs this program with `arguments` under callgrind; instructions by region. valgrind has no AVX-512,
/// so that the AVX2 kernels are what is counted. InputError when valgrind is missing or the child fails.
CountedRun count_instructions(const std::vector<std::string>& arguments);

/// The regions of callgrind's output files: their "Trigger: Client Request" and "totals" lines.
void add_counted_region(std::map<std::string, uint64_t>& regions, const std::string& callgrind_output);

}  // namespace rayloom::bench
