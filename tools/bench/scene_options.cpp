#include <rayloom/tools/bench/scene_options.h>

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/bench_scene.h>
#include <rayloom/tools/cli_values.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::bench {

void add_scene_options(CLI::App& app, std::vector<std::string>& scenes, std::string& directory,
                       const std::string& usual) {
  directory = default_scenes_directory();
  app.add_option("SCENES", scenes, fmt::format("Procedural scenes or files [{}, as far as they are there]", usual));
  app.add_option("--scenes-dir", directory, "Where to look for files [$RAYLOOM_SHARED_SCENES]")->type_name("DIR");
}

std::vector<std::string> choose_scenes(const std::vector<std::string>& named, const std::vector<std::string>& usual,
                                       const std::string& directory, std::vector<std::string>& missing) {
  if (!named.empty()) return named;
  std::vector<std::string> found;
  for (const std::string& name : usual) {
    if (bench_scene_exists(name, directory)) {
      found.push_back(name);
    } else {
      missing.push_back(name);
      fmt::print(stderr, "rayloom: scene '{}' is not there (see --scenes-dir), it is left out\n", name);
    }
  }
  return found;
}

std::vector<unsigned> parse_threads(const std::string& text) {
  std::vector<unsigned> threads;
  for (const std::string& word : tools::parse_names("--threads", text)) {
    threads.push_back(static_cast<unsigned>(tools::parse_count("--threads", word, 1, 1024)));
  }
  return threads;
}

bool parse_peer(const std::string& text, bool none_allowed) {
  if (text == "embree") return true;
  if (none_allowed && text == "none") return false;
  throw UsageError(fmt::format("--against: '{}' is no peer; there is embree{}", text, none_allowed ? " or none" : ""));
}

}  // namespace rayloom::bench
