#include <rayloom/runtime/pipeline.h>
#include <rayloom/runtime/state_object.h>

#include <algorithm>
#include <string>
#include <utility>

namespace rayloom {
namespace {

/// SID-08: case sensitive.
uint32_t part_of(const detail::HitGroup& group, std::string_view part) {
  if (part == "intersection") return group.intersection;
  if (part == "anyhit") return group.any_hit;
  if (part == "closesthit") return group.closest_hit;
  return detail::no_shader;
}

}  // namespace

StateObject::StateObject(const STATE_OBJECT_DESC& desc, std::shared_ptr<const ValidationCallback> validation)
    : pipeline_(std::make_unique<const detail::Pipeline>(detail::resolve_pipeline(desc))),
      validation_(std::move(validation)),
      stack_size_(pipeline_->default_stack_bytes()) {}

StateObject::~StateObject() = default;

const ShaderIdentifier* StateObject::GetShaderIdentifier(std::string_view export_name) const {
  const detail::Export* const found = pipeline_->find(export_name);
  return found ? &found->identifier : nullptr;
}

uint64_t StateObject::GetShaderStackSize(std::string_view export_name) const {
  using detail::ExportKind;
  if (const detail::Export* const whole = pipeline_->find(export_name); whole && whole->kind != ExportKind::hit_group)
    return pipeline_->shaders[whole->index].stack_bytes();
  const size_t colons = export_name.rfind("::");
  if (colons == std::string_view::npos) return invalid_stack_size;
  const detail::Export* const found = pipeline_->find(export_name.substr(0, colons));
  if (!found || found->kind != ExportKind::hit_group) return invalid_stack_size;
  const detail::ShaderDefinition* const shader =
      pipeline_->shader(part_of(pipeline_->hit_groups[found->index], export_name.substr(colons + 2)));
  return shader ? shader->stack_bytes() : invalid_stack_size;
}

void StateObject::SetPipelineStackSize(uint64_t bytes) const {
  if (bytes < invalid_stack_size) return stack_size_.store(bytes, std::memory_order_relaxed);
  if (validation_ && *validation_)
    (*validation_)({.id = "ERR-04",
                    .text = "SetPipelineStackSize: " + std::to_string(bytes) +
                            " bytes are no stack size; it stays at " + std::to_string(GetPipelineStackSize())});
}

uint32_t StateObject::local_root_bytes(std::string_view export_name) const {
  const detail::Export* const found = pipeline_->find(export_name);
  return found ? found->local_root_bytes : 0;
}

std::span<const ShaderInfo> StateObject::shaders() const { return pipeline_->infos; }

}  // namespace rayloom
