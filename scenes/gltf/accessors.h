#pragma once

// Reads accessors: every component type, strides, normalised integers, sparse substitution.

#include <rayloom/scenes/gltf/document.h>

#include <glm/glm.hpp>

namespace rayloom::scenes::gltf {

/// InputError unless every accessor lies inside its view, is aligned, and has a sparse part that does so too.
void check_accessors(const Document& document);

/// Bounds what a file may make us allocate: shared accessors let a small file ask for any amount of memory.
class Budget {
 public:
  explicit Budget(const Document& document);
  void take(uint64_t count, uint64_t bytes_each, const std::string& object);

 private:
  const Document& document_;
  uint64_t limit_;
  uint64_t taken_ = 0;
};

class AccessorReader {
 public:
  AccessorReader(const Document& document, Budget& budget) : document_(document), budget_(budget) {}

  const tinygltf::Accessor& at(int accessor) const { return document_.model.accessors[static_cast<size_t>(accessor)]; }
  /// Elements of `T` (vec2, vec3, vec4, mat4), normalised as the accessor says. InputError when a number is NaN or
  /// infinite, naming `user`, e.g. "meshes[0].primitives[1].attributes.POSITION", and the accessor's element.
  template <typename T>
  std::vector<T> read(int accessor, const std::string& user) const {
    budget_.take(at(accessor).count, sizeof(T), user);
    std::vector<T> elements(at(accessor).count);
    read_floats(accessor, user, reinterpret_cast<float*>(elements.data()), sizeof(T) / sizeof(float));
    return elements;
  }
  /// VEC4 joints or scalar indices as numbers.
  std::vector<uint32_t> read_uints(int accessor, const std::string& user) const;

 private:
  void read_floats(int accessor, const std::string& user, float* out, size_t per_element) const;
  std::vector<std::byte> gather(int accessor, const std::string& user) const;

  const Document& document_;
  Budget& budget_;
};

int component_count(int type);

}  // namespace rayloom::scenes::gltf
