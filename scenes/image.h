#pragma once

// Pictures for textures and environments. An image is encoded bytes, a file, or pixels made by a program; the first two
// are decoded through OpenImageIO when a pixel is first asked for, once, from whichever thread comes first.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace rayloom::scenes {

/// Decoded pixels, row 0 at the top, four channels RGBA (grey is spread, missing alpha is 1). Integer images of 8 bits
/// stay bytes; everything else becomes float, integers divided by their maximum. Values are as encoded: not linearised.
struct Pixels {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<uint8_t> bytes;  ///< 4 * width * height, or empty
  std::vector<float> floats;   ///< 4 * width * height, or empty; may exceed 1
};

class Image {
 public:
  /// `name` is what messages call it: a path, or "scene.glb: images[3]".
  static Image from_encoded(std::string name, std::vector<std::byte> encoded);
  static Image from_file(std::string path);
  /// Pixels in memory: nothing is ever decoded. InputError unless one of the two arrays has 4 * width * height entries.
  static Image from_pixels(std::string name, Pixels pixels);

  Image(Image&& other) noexcept;
  Image& operator=(Image&&) = delete;

  const std::string& name() const { return name_; }
  /// Decodes at the first call. InputError naming the image when it cannot be read; a later call throws again.
  const Pixels& pixels() const;
  /// False until a pixel was asked for; always false for pixels made by a program.
  bool decoded() const { return source_ != Source::pixels && ready_.load(std::memory_order_acquire); }
  /// Bytes now held: encoded and decoded.
  uint64_t memory_bytes() const;

 private:
  enum class Source : uint8_t { pixels, encoded, file };
  Image(std::string name, Source source) : name_(std::move(name)), source_(source) {}

  std::string name_;
  Source source_;
  std::vector<std::byte> encoded_;
  mutable std::mutex mutex_;
  mutable std::atomic<bool> ready_{false};
  mutable Pixels pixels_;
};

/// How many images this process has decoded so far: a scene whose textured meshes are never hit adds nothing.
uint64_t images_decoded();

}  // namespace rayloom::scenes
