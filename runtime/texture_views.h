#pragma once

// Two-dimensional arrays of T in device memory, rows one after another without gaps. See buffer_views.h for the rules.

#include <rayloom/runtime/buffer_views.h>

namespace rayloom {

namespace detail {
/// Address of the element at (x, y), 0 when it is outside.
template <class T>
uint64_t texel_address(uint64_t address, uint width, uint height, uint x, uint y) {
  return x < width && y < height ? address + (uint64_t{y} * width + x) * sizeof(T) : 0;
}
}  // namespace detail

template <class T>
struct Texture2D {
  uint64_t address = 0;
  uint width = 0, height = 0;

  T operator[](uint2 at) const { return Load(at); }
  T Load(uint2 at) const {
    const uint64_t texel = detail::texel_address<T>(address, width, height, at.x, at.y);
    return texel ? detail::load<T>(texel) : T{};
  }
};

template <class T>
struct RWTexture2D {
  uint64_t address = 0;
  uint width = 0, height = 0;

  detail::ElementReference<T> operator[](uint2 at) const {
    return detail::ElementReference<T>(detail::texel_address<T>(address, width, height, at.x, at.y));
  }
  /// For output[ctx.DispatchRaysIndex()]: z is not looked at.
  detail::ElementReference<T> operator[](uint3 at) const { return (*this)[uint2(at.x, at.y)]; }
  T Load(uint2 at) const { return (*this)[at]; }
  operator Texture2D<T>() const { return {address, width, height}; }
};

}  // namespace rayloom
