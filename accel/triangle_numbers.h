#pragma once

// Triangles of all geometries under one number each, and what a builder reads of them.

#include <rayloom/accel/float4.h>
#include <rayloom/accel/read_triangle.h>

#include <algorithm>
#include <span>
#include <vector>

namespace rayloom::accel {

/// Numbers count through the geometries in their order, inactive triangles included: they sort as names do.
class TriangleNumbers {
 public:
  explicit TriangleNumbers(std::span<const TriangleGeometry> geometries) : geometries_(geometries) {
    uint32_t begin = 0;
    for (const TriangleGeometry& geometry : geometries) {
      begin_.push_back(begin);
      begin += geometry.triangle_count;
    }
  }

  struct Name {
    uint32_t geometry, primitive;
  };
  Name name(uint32_t number) const {
    if (begin_.size() == 1) return {0, number};
    const auto next = std::upper_bound(begin_.begin(), begin_.end(), number);
    const auto geometry = static_cast<uint32_t>(next - begin_.begin()) - 1;
    return {geometry, number - begin_[geometry]};
  }

  std::span<const TriangleGeometry> geometries() const { return geometries_; }
  uint32_t begin(size_t geometry) const { return begin_[geometry]; }

 private:
  std::span<const TriangleGeometry> geometries_;
  std::vector<uint32_t> begin_;
};

/// Lane 3 is another z, which is never in the way of what all lanes are asked for.
inline Float4 load_vertex(const TriangleGeometry& geometry, uint32_t index) {
  using Float2 __attribute__((vector_size(8))) = float;
  const std::byte* const address = address_of_vertex(geometry, index);
  Float2 xy, yz;
  std::memcpy(&xy, address, sizeof(xy));
  std::memcpy(&yz, address + sizeof(float), sizeof(yz));
  if (!geometry.transform) return __builtin_shufflevector(xy, yz, 0, 1, 3, 3);
  float p[3] = {xy[0], xy[1], yz[1]};
  apply(geometry.transform, p);
  return Float4{p[0], p[1], p[2], p[2]};
}

struct Corners4 {
  Float4 corner[3];

  /// As make_primitive_ref: adding 0 turns -0 into +0.
  Box4 box() const {
    return {minimum(minimum(corner[0], corner[1]), corner[2]) + splat(0),
            maximum(maximum(corner[0], corner[1]), corner[2]) + splat(0)};
  }
};

inline Corners4 load_corners(const TriangleGeometry& geometry, const Indices& indices) {
  return {load_vertex(geometry, indices[0]), load_vertex(geometry, indices[1]), load_vertex(geometry, indices[2])};
}

namespace detail {
using Mask4 __attribute__((vector_size(16))) = int32_t;

inline bool all(Mask4 mask) {
  uint64_t half[2];
  std::memcpy(half, &mask, sizeof(half));
  return (half[0] & half[1]) == ~uint64_t{0};
}

inline Mask4 finite(Float4 x) {
  Mask4 bits;
  std::memcpy(&bits, &x, sizeof(bits));
  return (bits & Mask4{0x7FFFFFFF, 0x7FFFFFFF, 0x7FFFFFFF, 0x7FFFFFFF}) <
         Mask4{0x7F800000, 0x7F800000, 0x7F800000, 0x7F800000};
}
}  // namespace detail

/// Whether a triangle goes into leaves: all coordinates finite and, unless `keep_degenerate`, no two vertices equal
/// (triangle_refs in triangle_input.h).
inline bool is_kept(const Corners4& corners, bool keep_degenerate) {
  const Float4(&c)[3] = corners.corner;
  if (!detail::all(detail::finite(c[0]) & detail::finite(c[1]) & detail::finite(c[2]))) return false;
  return keep_degenerate || !(detail::all(c[0] == c[1]) || detail::all(c[1] == c[2]) || detail::all(c[2] == c[0]));
}

}  // namespace rayloom::accel
