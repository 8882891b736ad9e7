#include "parameters.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <charconv>

namespace rayloom::scenes {

Parameters::Parameters(const std::string& text) : text_(text), name_(text.substr(0, text.find(':'))) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return;
  for (size_t begin = colon + 1; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const size_t equals = part.find('=');
    int64_t value = 0;
    const char* last = part.data() + part.size();
    const char* first = equals == std::string::npos ? last : part.data() + equals + 1;
    const auto parsed = std::from_chars(first, last, value);
    if (first == last || parsed.ec != std::errc() || parsed.ptr != last) {
      throw InputError(text, part, "a parameter must be key=whole number");
    }
    values_[part.substr(0, equals)] = value;
    begin = end + 1;
  }
}

int64_t Parameters::get(const std::string& key, int64_t missing, int64_t min, int64_t max) {
  asked_[key] = true;
  const auto found = values_.find(key);
  if (found == values_.end()) return missing;
  if (found->second >= min && found->second <= max) return found->second;
  throw InputError(text_, key, fmt::format("{} must be at least {} and at most {}", found->second, min, max));
}

void Parameters::check_all_used() const {
  std::string known;
  for (const auto& [key, _] : asked_) known += " " + key;
  for (const auto& [key, _] : values_) {
    if (asked_.contains(key)) continue;
    throw InputError(text_, key, fmt::format("no such parameter; {} has{}", name_, known.empty() ? " none" : known));
  }
}

}  // namespace rayloom::scenes
