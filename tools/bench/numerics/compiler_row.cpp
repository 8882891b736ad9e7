// K6: the same hits whatever the compiler makes of the source.

#include <rayloom/base/error.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <unistd.h>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

namespace fs = std::filesystem;

/// A file that lives as long as this.
class TemporaryFile {
 public:
  TemporaryFile() {
    std::string name = (fs::temp_directory_path() / "rayloom_cases_XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) throw InputError(name + ": cannot be made");
    close(file);
    path_ = name;
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Writes cases for the variants and returns the hash that the library's own triangle test gives for them.
std::string write_cases(const std::string& path, uint64_t cases, uint64_t seed) {
  std::ofstream file(path, std::ios::binary);
  Random random(seed);
  Hash64 hash;
  for (uint64_t i = 0; i < cases; ++i) {
    const auto c = accel::test::random_case(random, accel::test::all_families[i % accel::test::all_families.size()]);
    file.write(reinterpret_cast<const char*>(&c.ray), sizeof(c.ray));
    file.write(reinterpret_cast<const char*>(&c.triangle), sizeof(c.triangle));
    const auto hit = product_subject().triangle(c.ray, c.triangle);
    hash.add(hit.has_value());
    if (hit) hash.add(hit->t).add(hit->u).add(hit->v).add(hit->front);
  }
  if (!file.flush()) throw InputError(path + ": cannot be written");
  return fmt::format("{:016x}", hash.value());
}

struct Hashes {
  std::string product, plain;
};

Hashes run_variant(const fs::path& program, const std::string& cases) {
  const std::string command = fmt::format("'{}' < '{}'", program.string(), cases);
  FILE* pipe = popen(command.c_str(), "r");
  char product[17] = "", plain[17] = "";
  const int read = pipe ? std::fscanf(pipe, "%16s %16s", product, plain) : 0;
  if (pipe) pclose(pipe);
  return read == 2 ? Hashes{product, plain} : Hashes{"did not run", ""};
}

std::vector<fs::path> variants() {
  std::vector<fs::path> programs;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(RAYLOOM_KERNEL_VARIANTS, none)) programs.push_back(entry.path());
  std::sort(programs.begin(), programs.end());
  return programs;
}

/// What the compilations came to, over all rounds.
struct Outcome {
  std::set<std::string> different, plain;
};

void run_round(RowRun& run, const std::vector<fs::path>& programs, uint64_t cases, uint64_t seed, Outcome& outcome) {
  const TemporaryFile file;
  const std::string expected = write_cases(file.path(), cases, seed);
  for (const fs::path& program : programs) {
    const Hashes hashes = run_variant(program, file.path());
    outcome.plain.insert(hashes.plain);
    if (hashes.product == expected || !outcome.different.insert(program.filename().string()).second) continue;
    run.note(fmt::format("{}: {} instead of {}", program.filename().string(), hashes.product, expected));
  }
}

}  // namespace

void run_contraction(RowRun& run) {
  constexpr uint64_t round_cases = 50000;  // 3 MB
  const auto programs = variants();
  const Cases rounds = run.slow(200000) / round_cases;
  Outcome outcome;
  run.repeat(rounds, [&](uint64_t i) { run_round(run, programs, round_cases, run.seed() + i, outcome); });
  run.none("compilations with other hits", outcome.different.size(), programs.size(), "compilations");
  run.at_most("compilations missing", programs.size() < 6 ? 6.0 - static_cast<double>(programs.size()) : 0, "", 0);
  run.at_most("flags that change a plain kernel missing", outcome.plain.size() <= rounds.count, "", 0);
  run.report("ray-triangle pairs in each", static_cast<double>(rounds.count * round_cases), "");
}

}  // namespace rayloom::bench::numerics
