#pragma once

// One TraceRay in flight, on the stack of the shader that called it.

#include <rayloom/runtime/lane.h>
#include <rayloom/runtime/shader_record.h>

#include <exception>

namespace rayloom::detail {

/// Attributes of a procedural hit, copied at ReportHit (IS-11).
struct ReportedAttributes {
  ReportedAttributes() {}  // the bytes have no meaning before there is a type
  ReportedAttributes(const void* data, const TypeInfo& data_type) : type(data_type) {
    std::memcpy(bytes, data, data_type.bytes);
  }

  alignas(16) std::byte bytes[RAYTRACING_MAX_ATTRIBUTE_SIZE_IN_BYTES];
  TypeInfo type;
};

struct RayFrame {
  RayFrame(Lane& tracing_lane, const TraceRayArguments& ray, void* ray_payload, const TypeInfo& type)
      : lane(&tracing_lane), arguments(&ray), payload(ray_payload), payload_type(type) {}

  Lane* lane;
  const TraceRayArguments* arguments;
  const TopLevel* scene = nullptr;  ///< null: the ray misses
  void* payload;
  const TypeInfo& payload_type;
  std::exception_ptr failure = nullptr;  ///< what an any-hit or intersection shader threw
  const accel::Hit* hit = nullptr;       ///< known when the lane goes on, and until its next shader begins
  ReportedAttributes reported;           ///< of the last accepted report (IS-10)

  SelectedRecord hit_record(const accel::InstanceRecord& instance, uint geometry_index) const {
    return select_record(*lane, lane->dispatch().hit_groups,
                         hit_group_index(arguments->ray_contribution, arguments->geometry_multiplier, geometry_index,
                                         instance.contribution_and_flags));
  }
  ShaderRecord record_at(uint64_t address) const { return {&lane->dispatch().hit_groups, address}; }
};

/// accel's callback: runs the any-hit or intersection shader of a candidate; `user` is the RayFrame.
accel::Verdict decide_candidate(void* user, const accel::Candidate& candidate) noexcept;

/// Reports what is wrong with a ray and its flags; only called when the validation layer is on.
void validate_ray(const Lane& lane, const TraceRayArguments& arguments, uint32_t pipeline_flags);

void report_payload(const RayFrame& frame, uint32_t shader);
/// True when the shader takes the ray's payload; reports otherwise (STG-13).
inline bool takes_payload(const RayFrame& frame, uint32_t shader) {
  if (frame.lane->dispatch().pipeline.code[shader].payload == frame.payload_type) [[likely]]
    return true;
  report_payload(frame, shader);
  return false;
}

}  // namespace rayloom::detail
