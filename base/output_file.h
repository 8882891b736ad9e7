#pragma once

// Files appear whole or not at all: bytes go to a temporary beside the target, and a checked close and a rename put it
// in place. Whatever fails on the way (no such directory, no permission, full disk) removes the temporary.

#include <string>
#include <string_view>

namespace rayloom {

/// One file being written. Every failure is an InputError naming the file and the system's reason.
/// A target that exists and is no regular file (/dev/stdout, a pipe) is written directly: it can neither be replaced
/// nor cleaned. A symbolic link keeps pointing where it points. A process that sets a file size limit should ignore
/// SIGXFSZ, whose default action ends the process before the error can be reported.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();  ///< without commit(): the target stays as it was
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);

  /// The file to write, for a library that opens by name; its extension is the target's. It exists, empty. Use either
  /// this or write().
  const std::string& temporary_path() const { return temporary_; }

  /// Makes the bytes durable and visible under the target's name.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;
  bool direct() const { return temporary_ == target_; }

  std::string path_;       // as the user gave it
  std::string target_;     // links resolved
  std::string temporary_;  // the target itself when it is written directly
  int file_ = -1;
};

/// Writes a whole file; "-" is standard output.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace rayloom
