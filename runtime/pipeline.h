#pragma once

// A state object, resolved: what the engine reads while it runs.

#include <rayloom/runtime/state_object.h>

#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::detail {

inline constexpr uint32_t no_shader = 0xFFFFFFFF;

struct HitGroup {
  std::string name;
  HIT_GROUP_TYPE type = HIT_GROUP_TYPE_TRIANGLES;
  uint32_t any_hit = no_shader, closest_hit = no_shader, intersection = no_shader;  ///< indices of shaders
};

/// What the engine reads of a shader each time it runs, in one cache line.
struct ShaderCode {
  ShaderEntry entry;
  const void* functor;
  TypeInfo payload;     ///< or parameters of a callable
  TypeInfo attributes;  ///< AH, CH
  uint64_t stack_bytes;
  ShaderStage stage;
};

enum class ExportKind : uint8_t { ray_generation, miss, callable, hit_group };

/// Something a shader record may select.
struct Export {
  std::string name;
  ExportKind kind = ExportKind::ray_generation;
  uint32_t index = 0;  ///< of a shader, or of a hit group
  uint32_t local_root_bytes = 0;
  ShaderIdentifier identifier{};
};

struct Pipeline {
  std::vector<ShaderDefinition> shaders;  ///< under their exported names
  std::vector<ShaderInfo> infos;          ///< of the same shaders, for tracers
  std::vector<ShaderCode> code;           ///< of the same shaders
  std::vector<HitGroup> hit_groups;
  std::vector<Export> exports;
  std::vector<ShaderIdentifier> identifiers;  ///< of the exports
  RAYTRACING_SHADER_CONFIG shader_config;
  RAYTRACING_PIPELINE_CONFIG config;
  bool decides_candidates = false;  ///< has an any-hit or intersection shader in a hit group

  void add_export(const std::string& name, ExportKind kind, size_t index, uint32_t local_root_bytes);
  const ShaderDefinition* shader(uint32_t index) const { return index == no_shader ? nullptr : &shaders[index]; }
  /// The export a record's 32 bytes name; null when they are not of this pipeline. The position travels inside, so that
  /// a lookup is one comparison.
  const Export* find(const std::byte* identifier) const {
    uint64_t word;
    std::memcpy(&word, identifier + 8, sizeof(word));
    const uint64_t position = word >> 8;
    if (position >= identifiers.size() ||
        std::memcmp(&identifiers[position], identifier, sizeof(ShaderIdentifier)) != 0)
      return nullptr;
    return &exports[position];
  }
  const Export* find(std::string_view name) const;
  uint64_t default_stack_bytes() const;
};

/// Follows all rules of checklist sections 2 and 3 that concern one scope; throws InputError.
Pipeline resolve_pipeline(const STATE_OBJECT_DESC& desc);

[[noreturn]] void fail_creation(const std::string& subobject, std::string_view row, const std::string& rule);

}  // namespace rayloom::detail
