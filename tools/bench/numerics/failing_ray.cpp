#include <rayloom/base/error.h>
#include <rayloom/tools/bench/numerics/failing_ray.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

std::string hex(float value) { return fmt::format("{:a}", value); }

/// The words of a line, one after the other.
class Words {
 public:
  Words(const std::string& line, std::string place) : stream_(line), place_(std::move(place)) {}

  bool next(std::string& word) { return static_cast<bool>(stream_ >> word); }
  std::string word() {
    std::string text;
    if (!next(text)) fail("the line ends too early");
    return text;
  }
  void expect(const std::string& name) {
    if (word() != name) fail("expected '" + name + "'");
  }
  uint64_t number(const std::string& name) {
    expect(name);
    const std::string text = word();
    if (text.find_first_not_of("0123456789") != std::string::npos) fail("'" + text + "' is no number");
    return std::strtoull(text.c_str(), nullptr, 10);
  }
  float real() {
    const std::string text = word();
    char* end = nullptr;
    const float value = std::strtof(text.c_str(), &end);
    if (*end != 0) fail("'" + text + "' is no float");
    return value;
  }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(place_ + ": " + what); }

 private:
  std::istringstream stream_;
  std::string place_;
};

}  // namespace

std::string to_line(const FailingRay& failing) {
  const Ray& ray = failing.ray;
  std::string line =
      fmt::format("{} seed {} part {} index {} ray", failing.row, failing.seed, failing.part, failing.index);
  for (const float x : ray.origin) line += " " + hex(x);
  line += " " + hex(ray.t_min);
  for (const float x : ray.direction) line += " " + hex(x);
  line += " " + hex(ray.t_max);
  for (const Triangle& triangle : failing.triangles) {
    line += " triangle";
    for (const Point& vertex : triangle)
      for (const float x : vertex) line += " " + hex(x);
  }
  return line;
}

FailingRay parse_failing_ray(const std::string& line, const std::string& place) {
  Words words(line, place);
  FailingRay failing;
  failing.row = words.word();
  failing.seed = words.number("seed");
  failing.part = words.number("part");
  failing.index = words.number("index");
  words.expect("ray");
  for (float& x : failing.ray.origin) x = words.real();
  failing.ray.t_min = words.real();
  for (float& x : failing.ray.direction) x = words.real();
  failing.ray.t_max = words.real();
  for (std::string word; words.next(word);) {
    if (word != "triangle") words.fail("expected 'triangle'");
    Triangle& triangle = failing.triangles.emplace_back();
    for (Point& vertex : triangle)
      for (float& x : vertex) x = words.real();
  }
  return failing;
}

std::vector<FailingRay> read_failing_rays(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  std::vector<FailingRay> rays;
  uint64_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    rays.push_back(parse_failing_ray(line, fmt::format("{}:{}", path, number)));
  }
  return rays;
}

void append_failing_rays(const std::string& path, const std::vector<FailingRay>& rays) {
  std::ofstream file(path, std::ios::app);
  for (const FailingRay& ray : rays) file << to_line(ray) << '\n';
  if (!file.flush()) throw InputError(path + ": cannot be written");
}

}  // namespace rayloom::bench::numerics
