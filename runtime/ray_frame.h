#pragma once

// One TraceRay in flight, on the stack of the shader that called it.

#include <rayloom/runtime/lane.h>
#include <rayloom/runtime/shader_record.h>

#include <exception>

namespace rayloom::detail {

/// Attributes of a procedural hit, copied at ReportHit (IS-11).
struct ReportedAttributes {
  ReportedAttributes() = default;
  ReportedAttributes(const void* data, const TypeInfo& data_type) : type(data_type) {
    std::memcpy(bytes, data, data_type.bytes);
  }

  alignas(16) std::byte bytes[RAYTRACING_MAX_ATTRIBUTE_SIZE_IN_BYTES] = {};
  TypeInfo type;
};

struct RayFrame : ActiveRay {
  Lane* lane = nullptr;
  const TraceRayArguments* arguments = nullptr;
  uint traversal_flags = 0;  ///< with the pipeline's, which shaders do not see (SV-26)
  const TopLevel* scene = nullptr;
  void* payload = nullptr;
  TypeInfo payload_type;
  ReportedAttributes reported;  ///< of the last accepted report (IS-10)
  std::exception_ptr failure;   ///< what an any-hit or intersection shader threw
  accel::Hit hit;

  SelectedRecord hit_record(const accel::InstanceRecord& instance, uint geometry_index) const {
    return select_record(*lane, lane->dispatch().desc().HitGroupTable,
                         hit_group_index(arguments->ray_contribution, arguments->geometry_multiplier, geometry_index,
                                         instance.contribution_and_flags),
                         ExportKind::hit_group);
  }
};

/// accel's callback: runs the any-hit or intersection shader of a candidate; `user` is the RayFrame.
accel::Verdict decide_candidate(void* user, const accel::Candidate& candidate) noexcept;

/// Reports what is wrong with a ray and its flags; only called when the validation layer is on.
void validate_ray(const Lane& lane, const TraceRayArguments& arguments, uint32_t pipeline_flags);

/// True when the shader takes the ray's payload; reports otherwise (STG-13).
bool takes_payload(const RayFrame& frame, const ShaderDefinition& shader);

}  // namespace rayloom::detail
