#pragma once

// HLSL's buffer views over device memory. A view is plain data (an address and a size), so it may be captured by a
// functor or stand in a root argument struct, and it is used by shaders; the host reads and writes Buffer (buffer.h).
// An index out of range loads zeros and drops stores. HLSL's typed Buffer<T> is StructuredBuffer<T> here.

#include <rayloom/runtime/hlsl.h>
#include <rayloom/runtime/shader_memory.h>

#include <bit>

namespace rayloom {

template <class T>
struct StructuredBuffer {
  uint64_t address = 0;
  uint64_t count = 0;

  T operator[](uint64_t index) const { return Load(index); }
  T Load(uint64_t index) const { return index < count ? detail::load<T>(address + index * sizeof(T)) : T{}; }
  uint64_t size() const { return count; }
};

template <class T>
struct RWStructuredBuffer {
  uint64_t address = 0;
  uint64_t count = 0;

  detail::ElementReference<T> operator[](uint64_t index) const {
    return detail::ElementReference<T>(index < count ? address + index * sizeof(T) : 0);
  }
  T Load(uint64_t index) const { return (*this)[index]; }
  uint64_t size() const { return count; }
  operator StructuredBuffer<T>() const { return {address, count}; }
};

/// One struct in device memory: `cb->member`, or `T value = *cb`.
template <class T>
struct ConstantBuffer {
  uint64_t address = 0;

  T operator*() const { return address ? detail::load<T>(address) : T{}; }
  struct Arrow {
    T value;
    const T* operator->() const { return &value; }
  };
  Arrow operator->() const { return {**this}; }
};

/// Raw bytes; offsets count bytes. HLSL's Load, Load2.. are Load<uint>, Load<uint2>..
struct ByteAddressBuffer {
  uint64_t address = 0;
  uint64_t bytes = 0;

  template <class T = uint>
  T Load(uint64_t offset) const {
    return holds(offset, sizeof(T)) ? detail::load<T>(address + offset) : T{};
  }
  uint2 Load2(uint64_t offset) const { return Load<uint2>(offset); }
  uint3 Load3(uint64_t offset) const { return Load<uint3>(offset); }
  uint4 Load4(uint64_t offset) const { return Load<uint4>(offset); }
  bool holds(uint64_t offset, uint64_t size) const { return offset <= bytes && size <= bytes - offset; }
};

struct RWByteAddressBuffer : ByteAddressBuffer {
  template <class T>
  void Store(uint64_t offset, const T& value) const {
    if (holds(offset, sizeof(T))) detail::store(address + offset, value);
  }
};

}  // namespace rayloom
