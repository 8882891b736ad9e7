#include <rayloom/base/error.h>
#include <rayloom/runtime/device.h>
#include <rayloom/runtime/shader_table.h>

#include <algorithm>

namespace rayloom {

ShaderTableBuilder& ShaderTableBuilder::add_record(std::string_view export_name, std::span<const std::byte> arguments) {
  const std::string object = "record '" + std::string(export_name) + "'";
  const ShaderIdentifier* const identifier = state_object_->GetShaderIdentifier(export_name);
  if (!identifier) throw InputError("shader table", object, "the state object has no identifier of that name [SID-04]");
  const uint32_t expected = state_object_->local_root_bytes(export_name);
  if (arguments.size() != expected)
    throw InputError("shader table", object,
                     "carries " + std::to_string(arguments.size()) + " bytes of local root arguments, its signature " +
                         std::to_string(expected) + " [RS-04]");
  std::vector<std::byte>& record = records_.emplace_back(identifier->begin(), identifier->end());
  record.insert(record.end(), arguments.begin(), arguments.end());
  return *this;
}

ShaderTableBuilder& ShaderTableBuilder::add_null() {
  records_.emplace_back(SHADER_IDENTIFIER_SIZE_IN_BYTES);
  return *this;
}

ShaderTable ShaderTableBuilder::build(Device& device) const {
  constexpr size_t alignment = RAYTRACING_SHADER_RECORD_BYTE_ALIGNMENT;
  size_t largest = alignment;
  for (const auto& record : records_) largest = std::max(largest, record.size());
  const size_t stride = (largest + alignment - 1) / alignment * alignment;
  Buffer buffer = device.create_buffer(stride * records_.size());
  for (size_t i = 0; i < records_.size(); ++i) buffer.upload(std::span<const std::byte>(records_[i]), i * stride);
  return ShaderTable(std::move(buffer), stride);
}

}  // namespace rayloom
