#pragma once

// A raytracing pipeline: shaders, hit groups, identifiers, stack sizes. Made by Device::CreateStateObject, immutable
// but for its pipeline stack size; safe to share between threads and dispatches.

#include <rayloom/runtime/state_object_desc.h>
#include <rayloom/runtime/validation.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace rayloom {

using ShaderIdentifier = std::array<std::byte, SHADER_IDENTIFIER_SIZE_IN_BYTES>;

/// 0xffffffff: no such shader (SID-09).
inline constexpr uint64_t invalid_stack_size = 0xffffffff;

namespace detail {
struct Pipeline;
}

class StateObject {
 public:
  /// Throws InputError naming the subobject and the checklist row it breaks; nothing is created then (SO-02).
  /// `validation` is told what is ignored later; Device::CreateStateObject gives the device's.
  explicit StateObject(const STATE_OBJECT_DESC& desc, std::shared_ptr<const ValidationCallback> validation = nullptr);
  ~StateObject();

  /// Null for unknown names and for shaders that are only parts of hit groups (SID-03, SID-04).
  const ShaderIdentifier* GetShaderIdentifier(std::string_view export_name) const;
  /// Hit groups: "group::intersection", "group::anyhit", "group::closesthit" (SID-08).
  uint64_t GetShaderStackSize(std::string_view export_name) const;
  uint64_t GetPipelineStackSize() const { return stack_size_.load(std::memory_order_relaxed); }
  /// Ignored, with a validation message, when 0xffffffff or more (SID-13, ERR-04). The size counts in the bytes
  /// GetShaderStackSize gives, and is enforced: a chain of shaders that needs more removes the device (RC-05).
  void SetPipelineStackSize(uint64_t bytes) const;

  /// Bytes of local root arguments the export's records carry; 0 without a local root signature, or for unknown names.
  uint32_t local_root_bytes(std::string_view export_name) const;
  std::span<const ShaderInfo> shaders() const;
  const detail::Pipeline& pipeline() const { return *pipeline_; }

 private:
  std::unique_ptr<const detail::Pipeline> pipeline_;
  std::shared_ptr<const ValidationCallback> validation_;
  mutable std::atomic<uint64_t> stack_size_;
};

}  // namespace rayloom
