#include <rayloom/base/output_file.h>

#include <rayloom/base/error.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace rayloom {

namespace {

int write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

std::string resolve_links(const std::string& path) {
  std::error_code error;
  const auto resolved = std::filesystem::weakly_canonical(path, error);
  return error ? path : resolved.string();
}

/// ".picture.1234-1.exr" beside "picture.exr": unique in this process and among processes, same extension.
std::string temporary_name(const std::string& target) {
  static std::atomic<unsigned> counter{0};
  const std::filesystem::path path(target);
  const std::string unique = "." + std::to_string(getpid()) + "-" + std::to_string(counter++);
  return path.parent_path() / ("." + path.stem().string() + unique + path.extension().string());
}

[[noreturn]] void fail_on(const std::string& path, int error) {
  throw InputError(path, "cannot write", std::generic_category().message(error));
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  struct stat status = {};
  const bool exists = ::stat(path_.c_str(), &status) == 0;
  const bool regular = !exists || S_ISREG(status.st_mode);
  target_ = regular ? resolve_links(path_) : path_;
  // The target's own permission counts, though a rename would only ask for the directory's.
  if (exists && ::access(target_.c_str(), W_OK) != 0) fail(errno);
  temporary_ = regular ? temporary_name(target_) : target_;
  file_ = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC | (regular ? O_CREAT | O_EXCL : 0), 0666);
  if (file_ < 0) fail(errno);
  if (exists && regular) ::fchmod(file_, status.st_mode & 07777);
}

OutputFile::~OutputFile() {
  if (file_ < 0) return;
  ::close(file_);
  if (!direct()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  if (const int error = write_all(file_, bytes)) fail(error);
}

void OutputFile::commit() {
  if (!direct()) {
    if (::fsync(file_) != 0) fail(errno);
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  }
  if (::close(std::exchange(file_, -1)) != 0) fail(errno);
}

void OutputFile::fail(int error) const { fail_on(path_, error); }

void write_file(const std::string& path, std::string_view bytes) {
  if (path == "-") {
    if (const int error = write_all(STDOUT_FILENO, bytes)) fail_on("standard output", error);
    return;
  }
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace rayloom
