#include "run_command.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace rayloom::tools {
namespace {

void limit(int resource, uint64_t bytes) {
  if (bytes == 0) return;
  const rlimit value{bytes, bytes};
  setrlimit(static_cast<__rlimit_resource>(resource), &value);
}

void redirect(int descriptor, const std::string& file) {
  const int target = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (target < 0 || dup2(target, descriptor) < 0) _exit(126);
}

/// The child's part: nothing here returns.
[[noreturn]] void become_rayloom(const std::vector<std::string>& arguments, const RunOptions& options,
                                 const std::filesystem::path& directory, const std::string& out,
                                 const std::string& err) {
  std::vector<char*> argv{const_cast<char*>("rayloom")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  if (chdir(directory.c_str()) != 0) _exit(126);
  redirect(STDOUT_FILENO, out);
  redirect(STDERR_FILENO, err);
  limit(RLIMIT_FSIZE, options.file_size_limit);
  limit(RLIMIT_AS, options.memory_limit);
  execv(RAYLOOM_BINARY, argv.data());
  _exit(127);
}

std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Scratch::Scratch() {
  std::string name = (std::filesystem::temp_directory_path() / "rayloom_test_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no scratch directory");
  path_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void Scratch::write(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
}

std::string Scratch::read(const std::string& name) const { return read_all(path_ / name); }

std::string Scratch::listing() const {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
    if (!entry.is_directory()) names.insert(std::filesystem::relative(entry.path(), path_).string());
  }
  std::string lines;
  for (const std::string& name : names) lines += name + "\n";
  return lines;
}

Outcome Scratch::rayloom(const std::vector<std::string>& arguments, const RunOptions& options) const {
  const std::string captured = path_.string() + ".out", errors = path_.string() + ".err";
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    become_rayloom(arguments, options, path_, options.stdout_to.empty() ? captured : options.stdout_to, errors);
  }
  if (options.interrupt_after_ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(options.interrupt_after_ms));
    kill(child, SIGINT);
  }
  int status = 0;
  waitpid(child, &status, 0);
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                  options.stdout_to.empty() ? read_all(captured) : "", read_all(errors)};
  std::filesystem::remove(captured);
  std::filesystem::remove(errors);
  return outcome;
}

}  // namespace rayloom::tools
