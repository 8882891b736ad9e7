#include <rayloom/tools/bench/process.h>

#include <rayloom/base/error.h>
#include <rayloom/base/output_file.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <boost/process/args.hpp>
#include <boost/process/child.hpp>
#include <boost/process/io.hpp>
#include <boost/process/search_path.hpp>
#include <fmt/format.h>

namespace rayloom::bench {

TemporaryDirectory::TemporaryDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "rayloom_XXXXXX").string();
  if (!mkdtemp(name.data())) throw InputError(name, "", "cannot make a temporary directory");
  path_ = name;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string read_whole_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments,
                          const std::string& input, const std::string& package) {
  namespace process = boost::process;
  const boost::filesystem::path path =
      program.find('/') == std::string::npos ? process::search_path(program) : boost::filesystem::path(program);
  if (path.empty() || !boost::filesystem::exists(path)) {
    throw InputError(program, "", fmt::format("not found; install the Debian package {}", package));
  }
  // Files, not pipes: neither side can wait for the other.
  const TemporaryDirectory scratch;
  write_file(scratch.file("in"), input);
  process::child child(path, process::args(arguments),
                       process::std_in<scratch.file("in"), process::std_out> scratch.file("out"),
                       process::std_err > scratch.file("err"));
  child.wait();
  return {child.exit_code(), read_whole_file(scratch.file("out")), read_whole_file(scratch.file("err"))};
}

}  // namespace rayloom::bench
