#pragma once

// Root signatures describe how root arguments lie in memory: those of a command list (global) and those after the
// identifier of a shader record (local). Layout by rule RS-04: in order of declaration, each argument aligned to its
// own size from the record's start; constants are 4-byte units, descriptors and table handles 8 bytes.

#include <rayloom/runtime/type_info.h>

#include <cstdint>
#include <vector>

namespace rayloom {

enum class RootParameterKind : uint8_t {
  constants,
  constant_buffer,
  shader_resource,
  unordered_access,
  table,
  structure
};

struct RootParameter {
  RootParameterKind kind = RootParameterKind::constants;
  uint32_t bytes = 0;
  uint32_t offset = 0;  ///< from the first argument; in a shader record add 32 for the identifier

  friend bool operator==(const RootParameter&, const RootParameter&) = default;
};

class RootSignature {
 public:
  static constexpr uint32_t max_local_bytes = 4064;  ///< CAP-08

  RootSignature& Constants(uint32_t num_32bit_values) {
    return add(RootParameterKind::constants, 4 * num_32bit_values, 4);
  }
  RootSignature& ConstantBufferView() { return add(RootParameterKind::constant_buffer, 8, 8); }
  RootSignature& ShaderResourceView() { return add(RootParameterKind::shader_resource, 8, 8); }
  RootSignature& UnorderedAccessView() { return add(RootParameterKind::unordered_access, 8, 8); }
  RootSignature& DescriptorTable() { return add(RootParameterKind::table, 8, 8); }
  /// A C++ struct of constants and views, read back with LocalRoot<T>() or GlobalRoot<T>().
  template <PlainStruct T>
  RootSignature& Struct() {
    return add(RootParameterKind::structure, sizeof(T), alignof(T));
  }

  const std::vector<RootParameter>& parameters() const { return parameters_; }
  uint32_t bytes() const { return bytes_; }

  friend bool operator==(const RootSignature&, const RootSignature&) = default;

 private:
  RootSignature& add(RootParameterKind kind, uint32_t bytes, uint32_t alignment) {
    const uint32_t offset = (bytes_ + alignment - 1) / alignment * alignment;
    parameters_.push_back({kind, bytes, offset});
    bytes_ = offset + bytes;
    return *this;
  }

  std::vector<RootParameter> parameters_;
  uint32_t bytes_ = 0;
};

}  // namespace rayloom
