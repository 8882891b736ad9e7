#include "registry.h"

#include "parameters.h"
#include "scenes.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace rayloom::scenes {
namespace {

struct Entry {
  std::string_view name;
  Scene (*make)(Parameters&);
  std::string_view help;
};

constexpr std::array entries = {
    Entry{"atrium", make_atrium, "a courtyard; detail=1..4 (1)"},
    Entry{"cornell", make_cornell, "a Cornell box"},
    Entry{"forest", make_forest, "over 100 million triangles in 4000 instances; trees=1..1000000 (4000), seed=N (1)"},
    Entry{"gallery", make_gallery,
          "the atrium with statues; statues=1..36 (36), triangles=5000..2000000 (120000) of each at least"},
    Entry{
        "hair", make_hair,
        "40000 strands of thin triangles; strands=1..1000000 (40000), segments=4..128 (20), micrometres=10..1000 (80), "
        "curl=0..100 (40)"},
    Entry{"spheres", make_spheres, "488 spheres for an intersection shader"},
    Entry{"terrain", make_terrain, "4.5 million triangles of mountains; resolution=8..4096 (1500), seed=N (1)"},
    Entry{"triangle", make_triangle, "one triangle"}};

const Entry* find_entry(std::string_view name) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

bool is_procedural_name(const std::string& text) { return find_entry(text.substr(0, text.find(':'))) != nullptr; }

std::string procedural_scene_names() {
  std::string names;
  for (const Entry& entry : entries) names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names;
}

std::string procedural_scene_help() {
  std::string text;
  for (const Entry& entry : entries) text += fmt::format("  {:<10}{}\n", entry.name, entry.help);
  return text;
}

Scene make_procedural_scene(const std::string& text) {
  Parameters parameters(text);
  const Entry* entry = find_entry(parameters.name());
  if (!entry) throw InputError(text, "", "no such procedural scene; those are " + procedural_scene_names());
  Scene scene = entry->make(parameters);
  parameters.check_all_used();
  scene.name = text;
  return scene;
}

}  // namespace rayloom::scenes
