#pragma once

// The identity of a payload, attribute, parameter or root argument struct, carried next to its bytes so that a shader
// never sees another struct than the one it was written for (STG-12, STG-13, CA-05).

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <typeinfo>

namespace rayloom {

/// A struct that HLSL could declare: copied as bytes, no constructor of its own needed.
template <class T>
concept PlainStruct = std::is_class_v<T> && std::is_trivially_copyable_v<T>;

struct TypeInfo {
  const std::type_info* type = nullptr;
  uint32_t bytes = 0;  ///< 0 for an empty struct (PL-04)

  explicit operator bool() const { return type != nullptr; }
  friend bool operator==(const TypeInfo& a, const TypeInfo& b) {
    return a.type == b.type || (a.type && b.type && *a.type == *b.type);
  }
};

namespace detail {
template <class T>
inline constexpr TypeInfo static_type_info{&typeid(T), std::is_empty_v<T> ? 0u : static_cast<uint32_t>(sizeof(T))};
}  // namespace detail

/// A constant in memory: to write it down for each call and read it back at once stalls the processor.
template <class T>
constexpr const TypeInfo& type_info_of() {
  return detail::static_type_info<T>;
}

}  // namespace rayloom
