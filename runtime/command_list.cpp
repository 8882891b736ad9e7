#include <rayloom/base/error.h>
#include <rayloom/runtime/command_list.h>
#include <rayloom/runtime/execute.h>

#include <algorithm>

namespace rayloom {
namespace {

uint64_t range(const Buffer& buffer, uint64_t offset, uint64_t bytes, const char* command, const char* which) {
  if (offset > buffer.bytes() || bytes > buffer.bytes() - offset)
    throw InputError(command, which,
                     std::to_string(bytes) + " bytes at offset " + std::to_string(offset) +
                         " lie outside of a buffer of " + std::to_string(buffer.bytes()) + " bytes");
  return buffer.address() + offset;
}

[[noreturn]] void fail_build(const char* object, const char* rule) {
  throw InputError("BuildRaytracingAccelerationStructure", object, rule);
}

}  // namespace

void CommandList::BuildRaytracingAccelerationStructure(const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_DESC& desc) {
  constexpr uint32_t both = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PREFER_FAST_TRACE |
                            RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PREFER_FAST_BUILD;
  if ((desc.Inputs.Flags & both) == both)
    fail_build("Inputs.Flags", "PREFER_FAST_TRACE and PREFER_FAST_BUILD exclude each other [BF-03]");
  const bool update = desc.Inputs.Flags & RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_PERFORM_UPDATE;
  if (desc.SourceAccelerationStructureData && !update)
    fail_build("SourceAccelerationStructureData", "is set without an update [BI-23]");
  if (update && !desc.SourceAccelerationStructureData)
    fail_build("SourceAccelerationStructureData", "is null, an update needs a source [BF-06]");
  if (desc.SourceAccelerationStructureData % RAYTRACING_ACCELERATION_STRUCTURE_BYTE_ALIGNMENT)
    fail_build("SourceAccelerationStructureData", "is no multiple of 256 [BI-22]");
  if (desc.DestAccelerationStructureData % RAYTRACING_ACCELERATION_STRUCTURE_BYTE_ALIGNMENT)
    fail_build("DestAccelerationStructureData", "is no multiple of 256 [BI-22]");
  commands_.emplace_back(detail::BuildCommand{desc, detail::copy_geometries(desc.Inputs)});
}

void CommandList::SetComputeRootSignature(const RootSignature& signature) {
  root_signature_ = signature;
  root_arguments_.assign(signature.bytes(), std::byte{0});
}

void CommandList::write_root(uint32_t parameter, RootParameterKind kind, uint64_t offset,
                             std::span<const std::byte> data) {
  const auto& parameters = root_signature_.parameters();
  const std::string object = "root parameter " + std::to_string(parameter);
  if (parameter >= parameters.size() || parameters[parameter].kind != kind)
    throw InputError("SetComputeRoot", object, "is not of this kind in the root signature that is set [RS-01]");
  const RootParameter& target = parameters[parameter];
  if (offset > target.bytes || data.size() > target.bytes - offset)
    throw InputError("SetComputeRoot", object, "has only " + std::to_string(target.bytes) + " bytes");
  std::copy(data.begin(), data.end(), root_arguments_.begin() + static_cast<ptrdiff_t>(target.offset + offset));
}

void CommandList::SetComputeRoot32BitConstants(uint32_t root_parameter, std::span<const uint32_t> values,
                                               uint32_t destination_offset_in_values) {
  write_root(root_parameter, RootParameterKind::constants, uint64_t{4} * destination_offset_in_values,
             std::as_bytes(values));
}
void CommandList::SetComputeRootConstantBufferView(uint32_t root_parameter, GPU_VIRTUAL_ADDRESS address) {
  write_root(root_parameter, RootParameterKind::constant_buffer, 0, std::as_bytes(std::span(&address, 1)));
}
void CommandList::SetComputeRootShaderResourceView(uint32_t root_parameter, GPU_VIRTUAL_ADDRESS address) {
  write_root(root_parameter, RootParameterKind::shader_resource, 0, std::as_bytes(std::span(&address, 1)));
}
void CommandList::SetComputeRootUnorderedAccessView(uint32_t root_parameter, GPU_VIRTUAL_ADDRESS address) {
  write_root(root_parameter, RootParameterKind::unordered_access, 0, std::as_bytes(std::span(&address, 1)));
}

void CommandList::CopyBufferRegion(const Buffer& destination, uint64_t destination_offset, const Buffer& source,
                                   uint64_t source_offset, uint64_t bytes) {
  commands_.emplace_back(
      detail::CopyCommand{range(destination, destination_offset, bytes, "CopyBufferRegion", "destination"),
                          range(source, source_offset, bytes, "CopyBufferRegion", "source"), bytes});
}

void CommandList::FillBuffer(const Buffer& destination, uint64_t offset, uint64_t bytes, uint32_t value) {
  if (offset % 4 || bytes % 4) throw InputError("FillBuffer", "", "offset and size must be multiples of 4");
  commands_.emplace_back(
      detail::FillCommand{range(destination, offset, bytes, "FillBuffer", "destination"), bytes, value});
}

void CommandList::WriteBuffer(const Buffer& destination, uint64_t offset, std::span<const std::byte> data) {
  commands_.emplace_back(detail::UploadCommand{range(destination, offset, data.size(), "WriteBuffer", "destination"),
                                               {data.begin(), data.end()}});
}

void CommandList::DispatchRays(const DISPATCH_RAYS_DESC& desc) {
  const uint64_t stack = state_object_ ? state_object_->GetPipelineStackSize() : 0;
  if (stack > detail::max_pipeline_stack_bytes)
    throw InputError("DispatchRays", "pipeline stack size",
                     std::to_string(stack) + " bytes a lane cannot be provided; the most is " +
                         std::to_string(detail::max_pipeline_stack_bytes) + " [RC-09]");
  commands_.emplace_back(detail::DispatchCommand{desc, state_object_, root_arguments_, stack});
}

}  // namespace rayloom
