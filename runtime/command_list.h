#pragma once

// Records commands; Device::execute runs them in order. Everything the host passes is copied when it is recorded;
// device memory (tables, instance descs, vertices) is read when the list executes (DR-08).

#include <rayloom/runtime/buffer.h>
#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/state_object.h>

#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace rayloom {

namespace detail {

struct BuildCommand {
  BUILD_RAYTRACING_ACCELERATION_STRUCTURE_DESC desc;  // its pointers are not used, `geometries` is
  std::vector<RAYTRACING_GEOMETRY_DESC> geometries;
};
struct CopyCommand {
  uint64_t destination, source, bytes;
};
struct FillCommand {
  uint64_t destination, bytes;
  uint32_t value;
};
struct UploadCommand {
  uint64_t destination;
  std::vector<std::byte> data;
};
struct DispatchCommand {
  DISPATCH_RAYS_DESC desc;
  std::shared_ptr<const StateObject> state_object;
  std::vector<std::byte> root_arguments;
  uint64_t stack_bytes;  // in effect when recorded (SID-14)
};
using Command = std::variant<BuildCommand, CopyCommand, FillCommand, UploadCommand, DispatchCommand>;

}  // namespace detail

class CommandList {
 public:
  /// `postbuild` info is a later issue. Mixed geometry types, bad alignments, and an update without source or a
  /// source without update throw InputError.
  void BuildRaytracingAccelerationStructure(const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_DESC& desc);

  void SetPipelineState1(std::shared_ptr<const StateObject> state_object) { state_object_ = std::move(state_object); }
  /// Null root signature: the one set before is forgotten, with all root arguments.
  void SetComputeRootSignature(const RootSignature& signature);
  void SetComputeRoot32BitConstants(uint32_t root_parameter, std::span<const uint32_t> values,
                                    uint32_t destination_offset_in_values = 0);
  void SetComputeRootConstantBufferView(uint32_t root_parameter, GPU_VIRTUAL_ADDRESS address);
  void SetComputeRootShaderResourceView(uint32_t root_parameter, GPU_VIRTUAL_ADDRESS address);
  void SetComputeRootUnorderedAccessView(uint32_t root_parameter, GPU_VIRTUAL_ADDRESS address);
  /// The whole of the root arguments as the struct ctx.GlobalRoot<T>() gives; also sets the signature Struct<T>().
  template <PlainStruct T>
  void SetComputeRoot(const T& arguments) {
    SetComputeRootSignature(RootSignature().Struct<T>());
    write_root(0, RootParameterKind::structure, 0, std::as_bytes(std::span(&arguments, 1)));
  }

  void CopyBufferRegion(const Buffer& destination, uint64_t destination_offset, const Buffer& source,
                        uint64_t source_offset, uint64_t bytes);
  /// Repeats a 32-bit value; offset and size are multiples of 4.
  void FillBuffer(const Buffer& destination, uint64_t offset, uint64_t bytes, uint32_t value);
  /// Writes host bytes, copied now, when the list executes.
  void WriteBuffer(const Buffer& destination, uint64_t offset, std::span<const std::byte> data);

  /// Throws InputError when the pipeline's stack cannot be provided (RC-09).
  void DispatchRays(const DISPATCH_RAYS_DESC& desc);

  /// Forgets all commands and state.
  void Reset() { *this = CommandList(); }
  std::span<const detail::Command> commands() const { return commands_; }

 private:
  void write_root(uint32_t parameter, RootParameterKind kind, uint64_t offset, std::span<const std::byte> data);

  std::vector<detail::Command> commands_;
  std::shared_ptr<const StateObject> state_object_;
  RootSignature root_signature_;
  std::vector<std::byte> root_arguments_;
};

}  // namespace rayloom
