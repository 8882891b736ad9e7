#pragma once

// A checked glTF document: tinygltf's structures, whose every index, type and byte range has been found valid, and the
// buffers' bytes. tinygltf gets neither buffers nor images: it would look for files in the working directory too, read
// images that may never be needed, and check a GLB's chunk lengths short by eight bytes.

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rayloom::scenes::gltf {

struct ImageSource {
  std::string name;
  std::string uri;  ///< empty: in a buffer view
  int buffer_view = -1;
};

struct Document {
  std::string file;       ///< as the user gave it, for messages
  std::string directory;  ///< where relative URIs are looked up
  tinygltf::Model model;
  std::vector<std::vector<std::byte>> buffers;
  std::vector<ImageSource> images;
  /// The view index of accessors without one (all zeros); tinygltf refuses to parse indices without a view.
  int zero_view = 0;
  uint64_t input_bytes = 0;  ///< of the file and its buffers: the scale of what it may ask us to allocate
  bool quantized = false;    ///< KHR_mesh_quantization is in use
  std::vector<std::string> unsupported_extensions;  ///< used, not required
  size_t animation_count = 0;
};

Document read_document(std::span<const std::byte> bytes, const std::string& name, const std::string& directory);

}  // namespace rayloom::scenes::gltf
