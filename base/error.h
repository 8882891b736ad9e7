#pragma once

// The project's error vocabulary. Three kinds, three answers:
//   InputError     what the user gave is bad (a file, a scene, an argument of an API): caught at the top, exit code 3;
//   UsageError     the command line is wrong: exit code 2;
//   anything else  a fault of ours: exit code 4 with a line that reproduces it.
// Expected failures ("no hit", "no split") are return values, never exceptions.

#include <stdexcept>
#include <string>
#include <string_view>

namespace rayloom {

/// Bad input. The message names the file (or the API object), the thing inside it and the rule it breaks:
/// "scene.gltf: meshes[3].primitives[0]: index 812 is out of range, the mesh has 400 vertices".
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  /// `file`: path as the user gave it. `object`: where in it (JSON path, row id, ...). `rule`: what is wrong.
  InputError(std::string_view file, std::string_view object, std::string_view rule)
      : std::runtime_error(join(file, object, rule)) {}

 private:
  static std::string join(std::string_view file, std::string_view object, std::string_view rule) {
    std::string text(file);
    if (!object.empty()) text.append(text.empty() ? "" : ": ").append(object);
    return text.append(text.empty() ? "" : ": ").append(rule);
  }
};

/// A wrong command line: unknown option, missing argument, a value out of its range.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rayloom
