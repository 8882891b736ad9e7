#pragma once

// JSON for people's scripts: keys keep the order they are written in, every document names its schema and version, and
// nothing but whole documents reaches a file.

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace rayloom {

using Json = nlohmann::ordered_json;

/// An object that begins {"schema": ..., "schema_version": ..., "rayloom_version": ...}. Raise `schema_version`
/// whenever a key is removed or changes its meaning.
Json json_document(std::string_view schema, unsigned schema_version);

/// Indented by two, with a final newline. Bytes that are no UTF-8 (a file name) become U+FFFD; NaN and infinities null.
std::string json_text(const Json& json);

/// Writes json_text() to a file, or to standard output for "-". Throws InputError; leaves no half-written file.
void write_json(const std::string& path, const Json& json);

}  // namespace rayloom
