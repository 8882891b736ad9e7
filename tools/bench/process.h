#pragma once

// Another program run to its end: gnuplot for charts, valgrind for instruction counts.

#include <string>
#include <vector>

namespace rayloom::bench {

struct ProcessResult {
  int exit_code = 0;
  std::string out, err;
};

/// Runs `program` (a path, or a name looked up in PATH) with `input` as its standard input. InputError when there is no
/// such program; it names `package`, the Debian package to install.
ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments,
                          const std::string& input, const std::string& package);

/// A directory of the process's own under the system's temporary directory, gone with the object.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// The bytes of a file; empty when it cannot be read.
std::string read_whole_file(const std::string& path);

}  // namespace rayloom::bench
