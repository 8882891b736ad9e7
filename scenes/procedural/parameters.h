#pragma once

// The "key=value,key=value" part of a procedural scene's name. Whole numbers only.

#include <cstdint>
#include <map>
#include <string>

namespace rayloom::scenes {

class Parameters {
 public:
  /// `text`: the whole name as the user gave it. InputError when it is not name[:key=value,...].
  explicit Parameters(const std::string& text);

  const std::string& name() const { return name_; }
  /// The value of `key`, or `missing`. InputError when it is outside [min, max].
  int64_t get(const std::string& key, int64_t missing, int64_t min, int64_t max);
  /// InputError when a parameter was given that nobody asked for.
  void check_all_used() const;

 private:
  std::string text_;
  std::string name_;
  std::map<std::string, int64_t> values_;
  std::map<std::string, bool> asked_;
};

}  // namespace rayloom::scenes
