#include "gltf_asset.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace rayloom::scenes::test {
namespace {

void append_u32(std::vector<std::byte>& bytes, uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFF));
}

Json with_buffer(const Asset& asset, const Json& buffer) {
  Json root = asset.root;
  if (!root.contains("buffers") && !asset.binary.empty()) root["buffers"] = Json::array({buffer});
  return root;
}

}  // namespace

Asset Asset::triangle() {
  Asset asset;
  asset.root = {{"asset", {{"version", "2.0"}}},
                {"scene", 0},
                {"scenes", {{{"nodes", {0}}}}},
                {"nodes", {{{"mesh", 0}, {"name", "node"}}}},
                {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}}};
  asset.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, gl_float, "VEC3", 3);
  asset.add_accessor(std::vector<uint16_t>{0, 1, 2}, gl_ushort, "SCALAR", 3);
  return asset;
}

int Asset::add_view_bytes(const void* data, size_t size, int stride) {
  binary.resize((binary.size() + 3) / 4 * 4);
  Json view = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}};
  if (stride != 0) view["byteStride"] = stride;
  const auto* bytes = static_cast<const std::byte*>(data);
  binary.insert(binary.end(), bytes, bytes + size);
  root["bufferViews"].push_back(view);
  return static_cast<int>(root["bufferViews"].size()) - 1;
}

int Asset::add_accessor_over(int view, int component_type, const char* type, size_t count, bool normalized) {
  Json accessor = {{"bufferView", view}, {"componentType", component_type}, {"type", type}, {"count", count}};
  if (normalized) accessor["normalized"] = true;
  root["accessors"].push_back(accessor);
  return static_cast<int>(root["accessors"].size()) - 1;
}

std::vector<std::byte> Asset::gltf() const {
  const Json buffer = {{"byteLength", binary.size()},
                       {"uri", "data:application/octet-stream;base64," + base64(binary)}};
  return as_bytes(with_buffer(*this, buffer).dump());
}

std::vector<std::byte> Asset::glb() const {
  return make_glb(with_buffer(*this, {{"byteLength", binary.size()}}).dump(), binary);
}

std::vector<std::byte> make_glb(std::string json, std::vector<std::byte> binary) {
  while (json.size() % 4 != 0) json += ' ';
  while (binary.size() % 4 != 0) binary.push_back(std::byte{0});
  std::vector<std::byte> glb = as_bytes("glTF");
  append_u32(glb, 2);
  append_u32(glb, static_cast<uint32_t>(12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size())));
  append_u32(glb, static_cast<uint32_t>(json.size()));
  append_u32(glb, 0x4E4F534A);
  const std::vector<std::byte> text = as_bytes(json);
  glb.insert(glb.end(), text.begin(), text.end());
  if (binary.empty()) return glb;
  append_u32(glb, static_cast<uint32_t>(binary.size()));
  append_u32(glb, 0x004E4942);
  glb.insert(glb.end(), binary.begin(), binary.end());
  return glb;
}

std::string base64(const std::vector<std::byte>& bytes) {
  const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t window = 0;
    for (size_t k = 0; k < 3; ++k)
      window = window << 8 | (i + k < bytes.size() ? std::to_integer<uint32_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? alphabet[window >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::vector<std::byte> as_bytes(const std::string& text) {
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

TemporaryDirectory::TemporaryDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "rayloom-test-XXXXXX").string();
  path_ = mkdtemp(pattern.data());
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::string TemporaryDirectory::write(const std::string& name, const std::vector<std::byte>& bytes) const {
  const std::string path = path_ + "/" + name;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

}  // namespace rayloom::scenes::test
