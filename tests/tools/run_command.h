#pragma once

// Runs the built rayloom command as a shell would and keeps everything it says.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rayloom::tools {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal when a signal ended it
  std::string out, err;
};

struct RunOptions {
  uint64_t file_size_limit = 0;     ///< RLIMIT_FSIZE in bytes, 0: none. Stands for a full disk.
  uint64_t memory_limit = 0;        ///< RLIMIT_AS in bytes, 0: none
  std::string stdout_to;            ///< file to redirect standard output to; empty: captured
  unsigned interrupt_after_ms = 0;  ///< send SIGINT after so long, 0: never
};

/// A directory of one test's own, the working directory of its commands, gone at its end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  /// Names of all files below, sorted, one line each.
  std::string listing() const;

  Outcome rayloom(const std::vector<std::string>& arguments, const RunOptions& options = {}) const;

 private:
  std::filesystem::path path_;
};

}  // namespace rayloom::tools
