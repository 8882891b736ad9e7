#pragma once

// Presets as tables; parameters.h makes configurations of them.

#include <rayloom/hwmodel/parameters.h>

#include <span>

namespace rayloom::hwmodel {

struct PresetValue {
  const char* key;
  uint32_t value;
  Confidence confidence;
  const char* source;
};

struct PresetDefinition {
  const char* name;
  const char* description;
  std::span<const PresetValue> values;  ///< one for every parameter
};

std::span<const PresetDefinition> preset_definitions();

}  // namespace rayloom::hwmodel
