#pragma once

// What `rayloom diff --metric flip` says of a FlipResult.

#include <rayloom/base/json.h>
#include <rayloom/tools/flip.h>

#include <string>

namespace rayloom::tools {

/// Mode, mean, pixels per degree, incomparable pixels and, in hdr mode, the exposures (null otherwise).
Json to_json(const FlipResult& result);

/// The same in one line of text.
std::string to_text(const FlipResult& result);

/// Writes the map: channel FLIP (.exr), or a heat map from 0 to 1 (.png).
void write_flip_map(const std::string& path, const FlipResult& result);

}  // namespace rayloom::tools
