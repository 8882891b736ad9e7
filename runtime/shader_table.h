#pragma once

// Writes shader tables: raw bytes in device memory, identifier then local root arguments, with the stride the largest
// record needs (ST-01, ST-02, ST-04). A table may as well be written by hand: nothing else is stored anywhere.

#include <rayloom/runtime/buffer.h>
#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/state_object.h>

#include <string_view>
#include <vector>

namespace rayloom {

class Device;

class ShaderTable {
 public:
  ShaderTable() = default;
  ShaderTable(Buffer buffer, uint64_t stride) : buffer_(std::move(buffer)), stride_(stride) {}

  uint64_t address() const { return buffer_.address(); }
  uint64_t stride() const { return stride_; }
  uint64_t count() const { return stride_ ? buffer_.bytes() / stride_ : 0; }
  const Buffer& buffer() const { return buffer_; }

  operator GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE() const { return {buffer_.address(), buffer_.bytes(), stride_}; }
  /// The table's first record, for RayGenerationShaderRecord.
  operator GPU_VIRTUAL_ADDRESS_RANGE() const { return {buffer_.address(), stride_}; }

 private:
  Buffer buffer_;
  uint64_t stride_ = 0;
};

class ShaderTableBuilder {
 public:
  /// `state_object` must live until build().
  explicit ShaderTableBuilder(const StateObject& state_object) : state_object_(&state_object) {}

  /// Appends a record. InputError when the name has no identifier or its local root signature has another size.
  ShaderTableBuilder& add(std::string_view export_name) { return add_record(export_name, {}); }
  template <PlainStruct LocalArguments>
  ShaderTableBuilder& add(std::string_view export_name, const LocalArguments& arguments) {
    return add_record(export_name, std::as_bytes(std::span(&arguments, 1)));
  }
  /// Appends a record with the NULL identifier (ST-14..16).
  ShaderTableBuilder& add_null();

  size_t count() const { return records_.size(); }
  ShaderTable build(Device& device) const;

 private:
  ShaderTableBuilder& add_record(std::string_view export_name, std::span<const std::byte> arguments);

  const StateObject* state_object_;
  std::vector<std::vector<std::byte>> records_;
};

}  // namespace rayloom
