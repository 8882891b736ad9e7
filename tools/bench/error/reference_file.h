#pragma once

// References kept in a file: one EXR holds any number of them, of one size, each in layers under its key. They take
// longest to render, and say the same every time.

#include <rayloom/tools/bench/error/reference.h>
#include <rayloom/tools/image.h>

#include <optional>
#include <string>

namespace rayloom::bench {

/// Names a reference: scene, size, bounces, samples, and the bits of a one-sample picture of it under a seed of its
/// own. Pictures are the same bits everywhere, so a change of the scene's content, or of how it is shaded, is another
/// key. Renders that sample with `renderer`.
std::string reference_key(shaders::Renderer& renderer, const std::string& scene, uint64_t samples);

class ReferenceFile {
 public:
  /// An empty path: nothing is kept. InputError when the file is there and is no picture of this size, or cannot be
  /// written.
  ReferenceFile(std::string path, uint32_t width, uint32_t height);

  std::optional<Reference> find(const std::string& key) const;
  /// Adds it and writes the file anew.
  void add(const std::string& key, const Reference& reference);

 private:
  std::string path_;
  tools::Image image_;
};

}  // namespace rayloom::bench
