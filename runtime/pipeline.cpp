#include <rayloom/base/hash.h>
#include <rayloom/runtime/pipeline.h>

#include <algorithm>
#include <cstring>

namespace rayloom::detail {
namespace {

constexpr uint64_t identifier_magic = 0x444853'4d4f4c52;  // marks an identifier as ours; keeps it from being all zero

ShaderIdentifier make_identifier(const Export& item, uint64_t position) {
  const uint64_t name_hash = hash64(item.name);
  const uint64_t words[4] = {identifier_magic, uint64_t{position} << 8 | static_cast<uint64_t>(item.kind), name_hash,
                             mix64(name_hash + position)};
  ShaderIdentifier identifier;
  std::memcpy(identifier.data(), words, sizeof(words));
  return identifier;
}

}  // namespace

void Pipeline::add_export(const std::string& name, ExportKind kind, size_t index, uint32_t local_root_bytes) {
  Export item{name, kind, static_cast<uint32_t>(index), local_root_bytes, {}};
  item.identifier = make_identifier(item, exports.size());
  identifiers.push_back(item.identifier);
  exports.push_back(std::move(item));
}

const Export* Pipeline::find(std::string_view name) const {
  const auto found = std::find_if(exports.begin(), exports.end(), [&](auto& item) { return item.name == name; });
  return found == exports.end() ? nullptr : &*found;
}

/// SID-12.
uint64_t Pipeline::default_stack_bytes() const {
  uint64_t largest[6] = {};
  for (const ShaderDefinition& shader : shaders) {
    uint64_t& most = largest[static_cast<size_t>(shader.stage)];
    most = std::max(most, shader.stack_bytes());
  }
  const auto most = [&](ShaderStage stage) { return largest[static_cast<size_t>(stage)]; };
  const uint64_t depth = config.MaxTraceRecursionDepth;
  const uint64_t shading = std::max(most(ShaderStage::closest_hit), most(ShaderStage::miss));
  const uint64_t deciding = most(ShaderStage::intersection) + most(ShaderStage::any_hit);
  return most(ShaderStage::ray_generation) + std::max(shading, deciding) * std::min<uint64_t>(1, depth) +
         shading * (depth > 1 ? depth - 1 : 0) + 2 * most(ShaderStage::callable);
}

}  // namespace rayloom::detail
