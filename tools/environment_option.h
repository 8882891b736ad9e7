#pragma once

#include <rayloom/scenes/scene.h>

#include <string>

namespace rayloom::tools {

/// What --environment says: "none", "r,g,b" (a constant sky of that radiance), or a latitude-longitude picture. An
/// empty text leaves the scene's own. UsageError for a colour that is none, InputError for a file that is not there.
void apply_environment(scenes::Scene& scene, const std::string& text, double scale);

}  // namespace rayloom::tools
