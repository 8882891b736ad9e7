#pragma once

// Options that the benches of scenes share.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rayloom::bench {

/// Adds SCENES and --scenes-dir. `usual`: the default list, for the help.
void add_scene_options(CLI::App& app, std::vector<std::string>& scenes, std::string& directory,
                       const std::string& usual);

/// `named`, or else those of `usual` that exist; what is missing is said on standard error and put into `missing`.
std::vector<std::string> choose_scenes(const std::vector<std::string>& named, const std::vector<std::string>& usual,
                                       const std::string& directory, std::vector<std::string>& missing);

/// "1,2" -> {1, 2}, for --threads. UsageError otherwise.
std::vector<unsigned> parse_threads(const std::string& text);

/// Whether --against names Embree; UsageError for anything but "embree" and, if allowed, "none".
bool parse_peer(const std::string& text, bool none_allowed);

}  // namespace rayloom::bench
