#pragma once

// A scene as world-space triangles: what both tracers of a comparison build from.

#include <rayloom/accel/build.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rayloom::bench {

struct TriangleSoup {
  std::vector<float> vertices;  ///< three a vertex, 16 bytes of slack at the end (the peer reads whole vectors)
  std::vector<uint32_t> indices;

  uint32_t vertex_count() const { return static_cast<uint32_t>(vertices.size() / 3 - 2); }
  uint32_t triangle_count() const { return static_cast<uint32_t>(indices.size() / 3); }
};

/// Flattens every triangle instance of a scene (a file or a procedural name).
TriangleSoup load_soup(const std::string& scene_name);

/// One bottom-level structure over the soup, in memory it owns.
class Structure {
 public:
  explicit Structure(const TriangleSoup& soup);
  ~Structure();
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;
  const std::byte* block() const { return block_; }
  uint64_t bytes() const { return bytes_; }

 private:
  std::byte* block_ = nullptr;
  uint64_t mapped_ = 0, bytes_ = 0;
};

}  // namespace rayloom::bench
