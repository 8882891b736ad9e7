#include "registry.h"

#include "parameters.h"
#include "scenes.h"

#include <rayloom/base/error.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace rayloom::scenes {
namespace {

struct Entry {
  std::string_view name;
  Scene (*make)(Parameters&);
};

constexpr std::array entries = {Entry{"atrium", make_atrium}, Entry{"cornell", make_cornell},
                                Entry{"spheres", make_spheres}, Entry{"triangle", make_triangle}};

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
