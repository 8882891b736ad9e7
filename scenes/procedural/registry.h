#pragma once

// Scenes made by a program, by name: "cornell", "atrium:detail=2". Same bits on every machine and thread count.

#include <rayloom/scenes/scene.h>

namespace rayloom::scenes {

/// Whether the part before the first ':' names a procedural scene (a file of that name is reached as "./name").
bool is_procedural_name(const std::string& text);

/// "atrium, cornell, spheres, ..."
std::string procedural_scene_names();

/// A line a scene: its name, what it is, its parameters with ranges and defaults.
std::string procedural_scene_help();

/// InputError for an unknown name, an unknown parameter, or a value out of its range.
Scene make_procedural_scene(const std::string& text);

}  // namespace rayloom::scenes
