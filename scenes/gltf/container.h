#pragma once

// The bytes of a glTF asset before any JSON is understood: files, GLB chunks, URIs.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::scenes::gltf {

struct Container {
  std::string_view json;
  std::span<const std::byte> binary;  ///< GLB's BIN chunk
  bool has_binary = false;
};

/// Takes a GLB apart (header and chunk lengths are checked); anything else counts as JSON. Views into `bytes`.
Container split_container(std::span<const std::byte> bytes, const std::string& file);

/// The whole file, or InputError naming `object` of `file` as what asked for it.
std::vector<std::byte> read_file(const std::string& path, const std::string& file, const std::string& object);

/// The file a relative URI names, percent-decoded. InputError for other schemes, absolute paths and missing files.
std::string resolve_uri(std::string_view uri, const std::string& directory, const std::string& file,
                        const std::string& object);

bool is_data_uri(std::string_view uri);
/// The bytes of "data:...;base64,...". InputError when it is not that, or holds what is not base64.
std::vector<std::byte> decode_data_uri(std::string_view uri, const std::string& file, const std::string& object);

}  // namespace rayloom::scenes::gltf
