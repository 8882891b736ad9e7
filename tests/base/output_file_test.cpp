#include <rayloom/base/output_file.h>

#include <rayloom/base/error.h>

#include <catch2/catch.hpp>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

using namespace rayloom;
namespace fs = std::filesystem;

namespace {

/// A directory of its own, gone with the object.
class Directory {
 public:
  Directory() {
    std::string pattern = fs::temp_directory_path() / "rayloom-XXXXXX";
    path_ = mkdtemp(pattern.data());
  }
  ~Directory() { fs::remove_all(path_); }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;

  std::string operator/(const std::string& name) const { return path_ / name; }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename());
    return names;
  }

 private:
  fs::path path_;
};

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A full disk for this process: no file may grow beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit = {bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_ = {};
  void (*old_handler_)(int);
};

}  // namespace

TEST_CASE("a file appears with commit and not before", "[output_file]") {
  const Directory directory;
  const std::string path = directory / "out.txt";
  OutputFile file(path);
  file.write("one ");
  file.write("two");
  CHECK_FALSE(fs::exists(path));
  file.commit();
  CHECK(contents(path) == "one two");
  CHECK(directory.files() == std::vector<std::string>{"out.txt"});
}

TEST_CASE("without commit the old file stays and nothing else does", "[output_file]") {
  const Directory directory;
  const std::string path = directory / "out.txt";
  write_file(path, "old");
  {
    OutputFile file(path);
    file.write("new");
  }
  CHECK(contents(path) == "old");
  CHECK(directory.files() == std::vector<std::string>{"out.txt"});
}

TEST_CASE("a library may write to the temporary by name, which has the target's extension", "[output_file]") {
  const Directory directory;
  const std::string path = directory / "picture.exr";
  OutputFile file(path);
  CHECK(fs::path(file.temporary_path()).extension() == ".exr");
  CHECK(fs::path(file.temporary_path()).parent_path() == fs::canonical(fs::path(path).parent_path()));
  std::ofstream(file.temporary_path(), std::ios::binary) << "pixels";
  file.commit();
  CHECK(contents(path) == "pixels");
}

TEST_CASE("replacing a file keeps its permissions and what links point to", "[output_file]") {
  const Directory directory;
  const std::string target = directory / "target.txt", link = directory / "link.txt";
  write_file(target, "old");
  fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("target.txt", link);
  write_file(link, "new");
  CHECK(fs::is_symlink(link));
  CHECK(contents(target) == "new");
  CHECK(fs::status(target).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("a missing directory, a directory and a file as directory are refused by name and reason", "[output_file]") {
  const Directory directory;
  write_file(directory / "file", "");
  CHECK_THROWS_WITH(write_file(directory / "none/out.txt", "x"),
                    Catch::Contains("none/out.txt: cannot write: No such file or directory"));
  CHECK_THROWS_WITH(write_file(directory / ".", "x"), Catch::Contains("Is a directory"));
  CHECK_THROWS_WITH(write_file(directory / "file/out.txt", "x"), Catch::Contains("Not a directory"));
  CHECK_THROWS_AS(write_file("", "x"), InputError);
  CHECK(directory.files() == std::vector<std::string>{"file"});
}

TEST_CASE("an unwritable directory or file is refused", "[output_file]") {
  if (geteuid() == 0) return;  // root may write anywhere
  const Directory directory;
  const std::string path = directory / "out.txt";
  write_file(path, "old");
  fs::permissions(path, fs::perms::owner_read);
  CHECK_THROWS_WITH(write_file(path, "new"), Catch::Contains("Permission denied"));
  CHECK(contents(path) == "old");
}

TEST_CASE("a disk that fills up leaves neither a half-written file nor a temporary", "[output_file]") {
  const Directory directory;
  const std::string path = directory / "out.txt";
  write_file(path, "old");
  {
    const FileSizeLimit limit(1000);
    CHECK_THROWS_WITH(write_file(path, std::string(2000, 'x')),
                      Catch::Contains("out.txt: cannot write: File too large"));
  }
  CHECK(contents(path) == "old");
  CHECK(directory.files() == std::vector<std::string>{"out.txt"});
}

TEST_CASE("a device is written directly and its errors are reported", "[output_file]") {
  write_file("/dev/null", "gone");
  CHECK(fs::is_character_file("/dev/null"));
  CHECK_THROWS_WITH(write_file("/dev/full", "x"), "/dev/full: cannot write: No space left on device");
  CHECK(fs::is_character_file("/dev/full"));
}
