#pragma once

// The validation layer: misuse told by checklist row. Off unless a callback is set; it never changes results (ERR-09).

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace rayloom {

enum class ValidationSeverity : uint8_t { info, warning, error };

/// Messages of a dispatch are gathered and told when it ends, once per row: `text` is that of the first offender by
/// linear lane index, `count` how often it happened. So they too are the same for any thread count.
struct ValidationMessage {
  std::string_view id;  ///< checklist row, for instance "ST-18"
  ValidationSeverity severity = ValidationSeverity::error;
  std::string text;
  uint64_t count = 1;
};

using ValidationCallback = std::function<void(const ValidationMessage&)>;

}  // namespace rayloom
