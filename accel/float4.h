#pragma once

// Four floats in one register, by the compilers' vector extension: every lane is computed as plain float code would.

#include <rayloom/accel/primitive_ref.h>

#include <cstddef>
#include <cstring>

namespace rayloom::accel {

using Float4 __attribute__((vector_size(16))) = float;

inline Float4 minimum(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 maximum(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 splat(float x) { return Float4{x, x, x, x}; }

/// A Box in two registers; lane 3 means nothing.
struct Box4 {
  Float4 min = splat(Box::infinity), max = splat(-Box::infinity);

  void extend(Float4 low, Float4 high) {
    min = minimum(min, low);
    max = maximum(max, high);
  }
  void extend(const Box4& box) { extend(box.min, box.max); }

  Box box() const {
    Box result;
    std::memcpy(result.min, &min, sizeof(result.min));
    std::memcpy(result.max, &max, sizeof(result.max));
    return result;
  }
};

/// Lane 3 is 0: names read as floats would be denormals, and arithmetic on those is slow.
inline Float4 load3(const std::byte* four) {
  using Bits4 __attribute__((vector_size(16))) = int32_t;
  Bits4 bits;
  std::memcpy(&bits, four, sizeof(bits));
  bits &= Bits4{-1, -1, -1, 0};
  Float4 result;
  std::memcpy(&result, &bits, sizeof(result));
  return result;
}
/// A reference's box, without the names that lie in each fourth place.
inline Box4 box4(const PrimitiveRef& ref) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&ref);
  return {load3(bytes), load3(bytes + offsetof(PrimitiveRef, max))};
}
inline Box4 box4(const Box& box) {
  return {Float4{box.min[0], box.min[1], box.min[2], 0}, Float4{box.max[0], box.max[1], box.max[2], 0}};
}
/// Stores a box in a reference, whose names are to be set afterwards.
inline void store(const Box4& box, PrimitiveRef& ref) {
  auto* const bytes = reinterpret_cast<std::byte*>(&ref);
  std::memcpy(bytes, &box.min, sizeof(box.min));
  std::memcpy(bytes + offsetof(PrimitiveRef, max), &box.max, sizeof(box.max));
}
/// As PrimitiveRef::centre.
inline Float4 centre4(const Box4& box) { return splat(0.5f) * box.min + splat(0.5f) * box.max; }

}  // namespace rayloom::accel
