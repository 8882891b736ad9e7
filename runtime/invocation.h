#pragma once

// What a stage context points at: the lane, the innermost ray and the primitive of one shader invocation, and the
// engine's side of the intrinsics. Shaders use stage_context.h.

#include <rayloom/accel/layout.h>
#include <rayloom/runtime/hlsl.h>
#include <rayloom/runtime/type_info.h>
#include <rayloom/runtime/verdict.h>

namespace rayloom::detail {

struct LaneIdentity {
  uint3 index{};
  uint3 dimensions{};
};

/// One TraceRay between call and return. `flags` are those the shader gave, defined bits only (SV-26).
struct ActiveRay {
  RayDesc desc;
  uint flags;
};

/// The candidate (IS, AH) or the committed hit (CH).
struct Primitive {
  const accel::InstanceRecord* instance = nullptr;
  uint instance_index = 0, geometry_index = 0, primitive_index = 0, hit_kind = 0;
};

struct RecordTable;

/// The shader record that selected a shader.
struct ShaderRecord {
  const RecordTable* table = nullptr;
  uint64_t address = 0;
};

struct Invocation {
  LaneIdentity* lane = nullptr;
  const ActiveRay* ray = nullptr;        ///< null in ray generation and callable shaders
  const Primitive* primitive = nullptr;  ///< intersection, any-hit, closest-hit
  float t_current = 0;                   ///< RayTCurrent of this stage (SV-24)
  ShaderRecord record;
};

/// What a shader gave TraceRay. Shaders the ray calls read the ray here, which the caller's own may not outlive.
struct TraceRayArguments : ActiveRay {
  uint64_t structure;
  uint instance_mask, ray_contribution, geometry_multiplier, miss_index;
};

void trace_ray(Invocation&, TraceRayArguments&, void* payload, const TypeInfo& payload_type);
void call_shader(Invocation&, uint shader_index, void* parameters, const TypeInfo& parameter_type);
ReportHitResult report_hit(Invocation&, float t, uint hit_kind, const void* attributes, const TypeInfo& attribute_type);
void mark_branch(Invocation&, uint signature);

/// Copies `bytes` of the local or global root arguments to `out`; zeros when they are not all there (ST-04, RS-15).
void read_local_root(Invocation&, void* out, uint32_t bytes);
void read_global_root(Invocation&, void* out, uint32_t bytes);

float3 object_ray_origin(const Invocation&);
float3 object_ray_direction(const Invocation&);
float3x4 object_to_world(const Invocation&);
float3x4 world_to_object(const Invocation&);

}  // namespace rayloom::detail
