#pragma once

// Bit-exact pictures: a hash of a render's floats, and the file of hashes they are compared with.

#include <rayloom/shaders/renderer.h>

#include <cstdint>
#include <map>
#include <string>

namespace rayloom::test {

/// FNV-1a over the bytes of width, height and every RGBA float.
uint64_t picture_hash(const shaders::Picture& picture);

struct PictureCase {
  std::string scene;  ///< a procedural scene, or "masked", see make_scene
  std::string program;
  uint32_t width = 32, height = 24, samples = 4, seed = 1;

  /// "scene program WxH spp=N seed=N": the key in hashes.txt.
  std::string key() const;
};

/// Procedural scenes by name, and "masked": a small scene of masked, blended and textured surfaces made here.
scenes::Scene make_scene(const std::string& name);
shaders::Picture render_case(const PictureCase& picture);

/// Reads lines "key: hash" (hexadecimal); '#' begins a comment.
std::map<std::string, uint64_t> read_hashes(const std::string& path);
void write_hashes(const std::string& path, const std::map<std::string, uint64_t>& hashes);

}  // namespace rayloom::test
