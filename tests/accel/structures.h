#pragma once

// Builds structures into memory of the size the sizes call for, and nothing more.

#include "meshes.h"

#include <rayloom/accel/box.h>
#include <rayloom/accel/build.h>
#include <rayloom/accel/structure.h>
#include <rayloom/accel/trace.h>

#include <cstdlib>
#include <cstring>
#include <memory>

namespace rayloom::accel::test {

/// A block on the heap, aligned as structures must be.
class Block {
 public:
  explicit Block(uint64_t bytes) : size_(bytes), data_(allocate(bytes), &std::free) {}

  std::byte* data() const { return data_.get(); }
  uint64_t size() const { return size_; }
  std::span<std::byte> span() const { return {data_.get(), size_}; }
  uint64_t address() const { return reinterpret_cast<uint64_t>(data_.get()); }
  const StructureHeader& header() const { return header_of(data_.get()); }
  uint64_t used = 0;  ///< what the build returned

 private:
  static std::byte* allocate(uint64_t bytes) {
    void* memory = std::aligned_alloc(structure_alignment, bytes);
    std::memset(memory, 0xCD, bytes);
    return static_cast<std::byte*>(memory);
  }
  uint64_t size_;
  std::unique_ptr<std::byte, decltype(&std::free)> data_;
};

template <class Geometry>
Block build_geometries(const std::vector<Geometry>& geometries, const BuildSettings& settings = build_flag::none) {
  const std::span<const Geometry> span(geometries);
  Block block(bottom_level_sizes(span, settings).result_bytes);
  block.used = build_bottom_level(span, settings, block.span());
  return block;
}

inline Block build_mesh(const Mesh& mesh, uint32_t geometry_flags = geometry_flag::opaque,
                        const BuildSettings& settings = build_flag::none) {
  return build_geometries(std::vector{mesh.geometry(geometry_flags)}, settings);
}

inline Block build_instances(const std::vector<InstanceDesc>& instances,
                             const BuildSettings& settings = build_flag::none) {
  Block block(top_level_sizes(instances.size(), settings).result_bytes);
  block.used = build_top_level(instances, {}, settings, block.span());
  return block;
}

inline InstanceDesc instance_of(const Block& bottom, const Transform3x4& transform = identity_transform) {
  InstanceDesc desc{};
  std::memcpy(desc.transform, transform.data(), sizeof(desc.transform));
  desc.instance_mask = 0xFF;
  desc.bottom_level_address = bottom.address();
  return desc;
}

inline TraceRequest request_for(const Block& block, const Ray& ray, uint32_t ray_flags = ray_flag::none) {
  TraceRequest request;
  request.ray = ray;
  request.structure = block.data();
  request.ray_flags = ray_flags;
  return request;
}

inline Ray ray_between(const Point& from, const Point& to) {
  return {{from[0], from[1], from[2]}, 0, {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, Box::infinity};
}

inline bool same_bits(const Hit& a, const Hit& b) {
  const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
  return bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) && bits(a.v) == bits(b.v) && a.type == b.type &&
         a.hit_kind == b.hit_kind && a.instance_index == b.instance_index && a.geometry_index == b.geometry_index &&
         a.primitive_index == b.primitive_index;
}

/// Runs `body(isa)` with each instruction set of this CPU in use; restores the choice.
template <class Body>
void for_each_isa(const Body& body) {
  const Isa before = current_isa();
  for (const Isa isa : {Isa::scalar, Isa::avx2, Isa::avx512})
    if (isa_supported(isa)) {
      set_isa(isa);
      body(isa);
    }
  set_isa(before);
}

}  // namespace rayloom::accel::test
