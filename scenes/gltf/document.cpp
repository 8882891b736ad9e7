#include "document.h"

#include "accessors.h"
#include "container.h"
#include "schema.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

namespace rayloom::scenes::gltf {
namespace {

std::vector<std::byte> buffer_bytes(const Json& buffer, size_t index, const Container& container,
                                    const Document& document) {
  const std::string object = fmt::format("buffers[{}]", index);
  if (buffer.contains("uri")) {
    const auto& uri = buffer["uri"].get_ref<const std::string&>();
    if (is_data_uri(uri)) return decode_data_uri(uri, document.file, object);
    return read_file(resolve_uri(uri, document.directory, document.file, object), document.file, object);
  }
  if (index != 0 || !container.has_binary) {
    throw InputError(document.file, object, "has no 'uri' and the file has no GLB binary chunk for it");
  }
  return {container.binary.begin(), container.binary.end()};
}

void take_buffers(Json& root, const Container& container, Document& document) {
  const Json buffers = root.value("buffers", Json::array());
  for (size_t i = 0; i < buffers.size(); ++i) {
    std::vector<std::byte> bytes = buffer_bytes(buffers[i], i, container, document);
    const uint64_t length = buffers[i]["byteLength"].get<uint64_t>();
    if (bytes.size() < length) {
      throw InputError(document.file, fmt::format("buffers[{}]", i),
                       fmt::format("truncated: byteLength says {} bytes, {} are there", length, bytes.size()));
    }
    bytes.resize(length);
    document.input_bytes += length;
    document.buffers.push_back(std::move(bytes));
  }
  root.erase("buffers");
}

void take_images(Json& root, Document& document) {
  for (const Json& image : root.value("images", Json::array())) {
    document.images.push_back({image.value("name", ""), image.value("uri", ""), image.value("bufferView", -1)});
  }
  root.erase("images");
}

void add_zero_view(Json& root, Document& document) {
  Json& views = root["bufferViews"];
  if (views.is_null()) views = Json::array();
  document.zero_view = static_cast<int>(views.size());
  views.push_back({{"buffer", 0}, {"byteLength", 1}});
  if (!root.contains("accessors")) return;
  for (Json& accessor : root["accessors"]) {
    if (!accessor.contains("bufferView")) accessor["bufferView"] = document.zero_view;
  }
}

void check_buffer_views(const Document& document) {
  const auto& views = document.model.bufferViews;
  for (size_t i = 0; i < static_cast<size_t>(document.zero_view); ++i) {
    const uint64_t size = document.buffers[static_cast<size_t>(views[i].buffer)].size();
    if (views[i].byteOffset <= size && views[i].byteLength <= size - views[i].byteOffset) continue;
    throw InputError(document.file, fmt::format("bufferViews[{}]", i),
                     fmt::format("bytes {} + {} reach beyond buffers[{}], which has {}", views[i].byteOffset,
                                 views[i].byteLength, views[i].buffer, size));
  }
}

bool no_files(const std::string&, void*) { return false; }
std::string same_path(const std::string& path, void*) { return path; }
bool read_nothing(std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; }
bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

void parse_model(const Json& root, Document& document) {
  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks({no_files, same_path, read_nothing, write_nothing, nullptr});
  const std::string text = root.dump();
  std::string errors, warnings;
  bool parsed = false;
  try {
    parsed = parser.LoadASCIIFromString(&document.model, &errors, &warnings, text.data(),
                                        static_cast<unsigned>(text.size()), "", tinygltf::REQUIRE_VERSION);
  } catch (const std::exception& error) {
    errors = error.what();
  }
  if (!parsed) throw InputError(document.file, "glTF", errors.empty() ? "tinygltf cannot read it" : errors);
}

}  // namespace

Document read_document(std::span<const std::byte> bytes, const std::string& name, const std::string& directory) {
  Document document;
  document.file = name;
  document.directory = directory;
  document.input_bytes = bytes.size();
  const Container container = split_container(bytes, name);
  if (container.json.size() > 0x7FFFFFFF) throw InputError(name, "JSON", "more than 2 GiB of JSON");
  Json root = parse_json(container.json, name);
  document.unsupported_extensions = check_extensions(root, name);
  check_schema(root, name);
  for (const Json& used : root.value("extensionsUsed", Json::array())) {
    document.quantized = document.quantized || used == "KHR_mesh_quantization";
  }
  document.animation_count = root.value("animations", Json::array()).size();
  prune(root);
  take_buffers(root, container, document);
  take_images(root, document);
  add_zero_view(root, document);
  parse_model(root, document);
  check_buffer_views(document);
  check_accessors(document);
  return document;
}

}  // namespace rayloom::scenes::gltf
