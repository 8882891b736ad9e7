#pragma once

// The channels a picture may have beside R G B A, by name ("N.X") and by layer ("N").

#include <rayloom/shaders/renderer.h>
#include <rayloom/tools/image.h>

#include <string>
#include <vector>

namespace rayloom::tools {

/// Layers in order, separated by spaces, for help texts.
std::string channel_layers();

/// Full channel names of a list of names and layers. UsageError naming `option` for an unknown one.
std::vector<std::string> expand_channels(const std::string& option, const std::vector<std::string>& names);

/// The rendered picture with the chosen channels behind R G B A. Traces for those it needs to.
Image make_image(shaders::Renderer& renderer, const std::vector<std::string>& channels);

}  // namespace rayloom::tools
