#pragma once

// Checks a glTF document's JSON against the rules of the specification's schema that the importer relies on: types,
// required members, index ranges, numeric ranges, enumerations. After it, tinygltf and the importer need not doubt any.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::scenes::gltf {

using Json = nlohmann::json;

/// Parsed text. InputError with line and column when it is no JSON, nests deeper than 64, or is no object.
Json parse_json(std::string_view text, const std::string& file);

/// InputError naming the JSON object and the rule it breaks.
void check_schema(const Json& root, const std::string& file);

/// Throws when `extensionsRequired` names one we do not have; returns those used that we do not have.
std::vector<std::string> check_extensions(const Json& root, const std::string& file);

/// Removes everything the importer does not read: extras, unknown extensions, animations.
void prune(Json& root);

}  // namespace rayloom::scenes::gltf
