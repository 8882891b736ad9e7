#include "container.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace rayloom::scenes::gltf {
namespace {

constexpr uint32_t chunk_json = 0x4E4F534A;
constexpr uint32_t chunk_binary = 0x004E4942;

uint32_t little_endian(std::span<const std::byte> bytes, size_t offset) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | std::to_integer<uint32_t>(bytes[offset + i]);
  return value;
}

bool is_glb(std::span<const std::byte> bytes) { return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0; }

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string_view without_padding(std::string_view json) {
  while (!json.empty() && json.back() == '\0') json.remove_suffix(1);
  return json;
}

/// The GLB up to its stated length (GLB 2.0, 4.4.2).
std::span<const std::byte> checked_glb(std::span<const std::byte> bytes, const std::string& file) {
  if (bytes.size() < 12) throw InputError(file, "GLB header", "the file ends inside the 12-byte header");
  const uint32_t version = little_endian(bytes, 4), length = little_endian(bytes, 8);
  if (version != 2) throw InputError(file, "GLB header", fmt::format("version must be 2, it is {}", version));
  if (length > bytes.size()) {
    throw InputError(file, "GLB header",
                     fmt::format("truncated: length says {} bytes, the file has {}", length, bytes.size()));
  }
  if (length < 12) throw InputError(file, "GLB header", fmt::format("length {} is less than the header", length));
  return bytes.first(length);
}

std::array<int8_t, 256> base64_values() {
  std::array<int8_t, 256> table;
  table.fill(-1);
  const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (int8_t i = 0; i < 64; ++i) table[static_cast<uint8_t>(alphabet[i])] = i;
  return table;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0;
    if (escape) {
      text += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

}  // namespace

Container split_container(std::span<const std::byte> bytes, const std::string& file) {
  if (!is_glb(bytes)) return {as_text(bytes), {}, false};
  bytes = checked_glb(bytes, file);
  Container container;
  for (size_t offset = 12, chunk = 0; offset < bytes.size(); ++chunk) {
    const std::string object = fmt::format("GLB chunk {}", chunk);
    if (bytes.size() - offset < 8) throw InputError(file, object, "truncated inside the chunk header");
    const uint32_t length = little_endian(bytes, offset), type = little_endian(bytes, offset + 4);
    const size_t left = bytes.size() - offset - 8;
    if (length > left) throw InputError(file, object, fmt::format("length {}, but {} bytes are left", length, left));
    if (length % 4 != 0) throw InputError(file, object, fmt::format("length {} is not a multiple of 4", length));
    if (chunk == 0 && type != chunk_json) throw InputError(file, object, "the first chunk must be of type JSON");
    const auto data = bytes.subspan(offset + 8, length);
    if (chunk == 0) container.json = without_padding(as_text(data));
    if (chunk == 1 && type == chunk_binary) container.binary = data, container.has_binary = true;
    offset += 8 + size_t{length};
  }
  if (container.json.empty()) throw InputError(file, "GLB chunk 0", "the JSON chunk is missing or empty");
  return container;
}

std::vector<std::byte> read_file(const std::string& path, const std::string& file, const std::string& object) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(file, object, path == file ? "no such file" : fmt::format("file '{}' does not exist", path));
  }
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : -1;
  std::vector<std::byte> bytes(size > 0 ? static_cast<size_t>(size) : 0);
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream || size < 0) throw InputError(file, object, fmt::format("file '{}' cannot be read", path));
  return bytes;
}

std::string resolve_uri(std::string_view uri, const std::string& directory, const std::string& file,
                        const std::string& object) {
  const std::string relative = percent_decoded(uri);
  const std::filesystem::path path(relative);
  if (relative.empty() || relative.find('\0') != std::string::npos || path.is_absolute() ||
      relative.find("://") != std::string::npos) {
    throw InputError(file, object, fmt::format("uri '{}' must be a relative path or a data URI", uri.substr(0, 200)));
  }
  std::error_code error;
  const std::string resolved = (std::filesystem::path(directory) / path).string();
  if (!std::filesystem::is_regular_file(resolved, error)) {
    throw InputError(file, object, fmt::format("file '{}' does not exist", resolved));
  }
  return resolved;
}

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::vector<std::byte> decode_data_uri(std::string_view uri, const std::string& file, const std::string& object) {
  static const std::array<int8_t, 256> values = base64_values();
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
    throw InputError(file, object, "a data URI must be base64: data:<type>;base64,<data>");
  }
  std::string_view text = uri.substr(comma + 1);
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) throw InputError(file, object, "the base64 data is truncated");
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t window = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const int8_t value = values[static_cast<uint8_t>(text[i])];
    if (value < 0) throw InputError(file, object, fmt::format("character {} of the data is not base64", i));
    window = window << 6 | static_cast<uint32_t>(value);
    if (i % 4 != 0) bytes.push_back(static_cast<std::byte>(window >> (6 - i % 4 * 2) & 0xFF));
  }
  return bytes;
}

}  // namespace rayloom::scenes::gltf
