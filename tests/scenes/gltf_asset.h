#pragma once

// glTF files made in memory for tests: JSON that a test may change at will, and the bytes of one buffer.

#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rayloom::scenes::test {

using Json = nlohmann::json;

inline constexpr int gl_byte = 5120, gl_ubyte = 5121, gl_short = 5122, gl_ushort = 5123, gl_uint = 5125,
                     gl_float = 5126;

struct Asset {
  Json root;
  std::vector<std::byte> binary;

  /// A triangle (0,0,0) (1,0,0) (0,1,0) with 16-bit indices: accessors 0 (POSITION) and 1 (indices), one node.
  static Asset triangle();

  /// A view over a copy of `values`, starting at a multiple of four; returns its index.
  template <typename T>
  int add_view(const std::vector<T>& values, int stride = 0) {
    return add_view_bytes(values.data(), values.size() * sizeof(T), stride);
  }
  int add_view_bytes(const void* data, size_t size, int stride);
  /// An accessor over such a view; returns its index.
  template <typename T>
  int add_accessor(const std::vector<T>& values, int component_type, const char* type, size_t count,
                   bool normalized = false, int stride = 0) {
    return add_accessor_over(add_view(values, stride), component_type, type, count, normalized);
  }
  int add_accessor_over(int view, int component_type, const char* type, size_t count, bool normalized = false);
  Json& primitive() { return root["meshes"][0]["primitives"][0]; }

  std::vector<std::byte> gltf() const;  ///< the buffer as a data URI
  std::vector<std::byte> glb() const;
};

std::string base64(const std::vector<std::byte>& bytes);
std::vector<std::byte> as_bytes(const std::string& text);
/// A GLB of these chunks.
std::vector<std::byte> make_glb(std::string json, std::vector<std::byte> binary);

/// A directory of its own under the system's temporary one, removed with everything in it.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  std::string write(const std::string& name, const std::vector<std::byte>& bytes) const;  ///< returns the path
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace rayloom::scenes::test
