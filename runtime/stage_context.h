#pragma once

// The first parameter of every shader. A context offers exactly the intrinsics and system values its stage has in DXR
// 1.1 (checklist STG-01..04, SV-01..08): anything else does not compile. A shader that changes the float modes (MXCSR)
// puts them back before it calls one of these or returns.

#include <rayloom/runtime/invocation.h>

#include <cstring>

namespace rayloom {

namespace detail {
template <ShaderStage S, ShaderStage... Set>
inline constexpr bool stage_is_one_of = ((S == Set) || ...);
}  // namespace detail

/// TraceRay: ray generation, closest hit, miss (STG-01).
template <ShaderStage S>
concept MayTraceRay =
    detail::stage_is_one_of<S, ShaderStage::ray_generation, ShaderStage::closest_hit, ShaderStage::miss>;
/// CallShader: ray generation, closest hit, miss, callable (STG-02).
template <ShaderStage S>
concept MayCallShader = MayTraceRay<S> || S == ShaderStage::callable;
/// ReportHit: intersection (STG-03).
template <ShaderStage S>
concept MayReportHit = S == ShaderStage::intersection;
/// IgnoreHit, AcceptHitAndEndSearch: any-hit (STG-04).
template <ShaderStage S>
concept MayDecideHit = S == ShaderStage::any_hit;
/// Ray values: every stage a ray calls (SV-02, SV-03).
template <ShaderStage S>
concept HasRay = detail::stage_is_one_of<S, ShaderStage::intersection, ShaderStage::any_hit, ShaderStage::closest_hit,
                                         ShaderStage::miss>;
/// Primitive and instance values (SV-04..SV-07).
template <ShaderStage S>
concept HasPrimitive = HasRay<S> && S != ShaderStage::miss;
/// HitKind (SV-08).
template <ShaderStage S>
concept HasHit = detail::stage_is_one_of<S, ShaderStage::any_hit, ShaderStage::closest_hit>;

template <ShaderStage S>
class StageContext {
 public:
  explicit StageContext(detail::Invocation& invocation) : self_(invocation) {}
  StageContext(const StageContext&) = delete;
  StageContext& operator=(const StageContext&) = delete;

  /// Of the ray generation thread this shader descends from, at any depth (SV-20).
  uint3 DispatchRaysIndex() const { return self_.lane->index; }
  uint3 DispatchRaysDimensions() const { return self_.lane->dimensions; }

  /// Of the innermost ray; the bits that were passed to TraceRay (SV-21, SV-22).
  float3 WorldRayOrigin() const requires HasRay<S> { return self_.ray->desc.Origin; }
  float3 WorldRayDirection() const requires HasRay<S> { return self_.ray->desc.Direction; }
  float RayTMin() const requires HasRay<S> { return self_.ray->desc.TMin; }
  /// IS: closest accepted so far; AH: the hit under test; CH: the committed hit; MS: TMax (SV-24).
  float RayTCurrent() const requires HasRay<S> { return self_.t_current; }
  uint RayFlags() const requires HasRay<S> { return self_.ray->flags; }

  uint InstanceIndex() const requires HasPrimitive<S> { return self_.primitive->instance_index; }
  uint InstanceID() const requires HasPrimitive<S> { return self_.primitive->instance->id_and_mask & 0xFFFFFFu; }
  uint GeometryIndex() const requires HasPrimitive<S> { return self_.primitive->geometry_index; }
  uint PrimitiveIndex() const requires HasPrimitive<S> { return self_.primitive->primitive_index; }
  float3 ObjectRayOrigin() const requires HasPrimitive<S> { return detail::object_ray_origin(self_); }
  float3 ObjectRayDirection() const requires HasPrimitive<S> { return detail::object_ray_direction(self_); }
  float3x4 ObjectToWorld3x4() const requires HasPrimitive<S> { return detail::object_to_world(self_); }
  float4x3 ObjectToWorld4x3() const requires HasPrimitive<S> { return glm::transpose(ObjectToWorld3x4()); }
  float3x4 WorldToObject3x4() const requires HasPrimitive<S> { return detail::world_to_object(self_); }
  float4x3 WorldToObject4x3() const requires HasPrimitive<S> { return glm::transpose(WorldToObject3x4()); }
  uint HitKind() const requires HasHit<S> { return self_.primitive->hit_kind; }

  /// Every shader the ray calls has finished when this returns (TR-02); `ray` is not changed (TR-14).
  template <PlainStruct Payload>
  void TraceRay(RaytracingAccelerationStructure scene, uint RayFlags, uint InstanceInclusionMask,
                uint RayContributionToHitGroupIndex, uint MultiplierForGeometryContributionToHitGroupIndex,
                uint MissShaderIndex, const RayDesc& ray, Payload& payload) requires MayTraceRay<S> {
    detail::TraceRayArguments arguments{{ray, RayFlags},
                                        scene.address,
                                        InstanceInclusionMask,
                                        RayContributionToHitGroupIndex,
                                        MultiplierForGeometryContributionToHitGroupIndex,
                                        MissShaderIndex};
    detail::trace_ray(self_, arguments, &payload, type_info_of<Payload>());
  }

  template <PlainStruct Parameters>
  void CallShader(uint ShaderIndex, Parameters& parameters) requires MayCallShader<S> {
    detail::call_shader(self_, ShaderIndex, &parameters, type_info_of<Parameters>());
  }

  /// Accepted when t lies in [RayTMin, RayTCurrent] and no any-hit shader ignores it (IS-04..06). HitKind: 0..127.
  template <PlainStruct Attributes>
  ReportHitResult ReportHit(float THit, uint HitKind, const Attributes& attributes) requires MayReportHit<S> {
    static_assert(sizeof(Attributes) <= 32, "rayloom: attributes take at most 32 bytes [IS-13]");
    return detail::report_hit(self_, THit, HitKind, &attributes, type_info_of<Attributes>());
  }
  /// The end of an intersection shader that has no ReportHit to return.
  IntersectionVerdict EndIntersection() const requires MayReportHit<S> {
    return IntersectionVerdict(IntersectionVerdict::Private{});
  }

  /// HLSL's plain return from an any-hit shader: the hit is committed, the search goes on (AH-02).
  AnyHitVerdict AcceptHit() const requires MayDecideHit<S> { return AnyHitVerdict(detail::HitDecision::accept); }
  AnyHitVerdict IgnoreHit() const requires MayDecideHit<S> { return AnyHitVerdict(detail::HitDecision::ignore); }
  AnyHitVerdict AcceptHitAndEndSearch() const requires MayDecideHit<S> {
    return AnyHitVerdict(detail::HitDecision::accept_and_end_search);
  }

  /// Root arguments as the struct they were written from: those of the command list, and those after the identifier of
  /// the shader record that selected this shader (RS-01, RS-02). Zeros, and a validation message, when too short.
  template <PlainStruct Arguments>
  Arguments GlobalRoot() const {
    return read_root<Arguments>(detail::read_global_root);
  }
  template <PlainStruct Arguments>
  Arguments LocalRoot() const {
    return read_root<Arguments>(detail::read_local_root);
  }

  /// Marks the way this invocation took: for the hardware model, lanes with different marks share no instructions.
  void Branch(uint signature) { detail::mark_branch(self_, signature); }

 private:
  template <class Arguments>
  Arguments read_root(void (*read)(detail::Invocation&, void*, uint32_t)) const {
    Arguments arguments;
    read(self_, static_cast<void*>(&arguments), sizeof(Arguments));
    return arguments;
  }

  detail::Invocation& self_;
};

using RayGenContext = StageContext<ShaderStage::ray_generation>;
using IntersectionContext = StageContext<ShaderStage::intersection>;
using AnyHitContext = StageContext<ShaderStage::any_hit>;
using ClosestHitContext = StageContext<ShaderStage::closest_hit>;
using MissContext = StageContext<ShaderStage::miss>;
using CallableContext = StageContext<ShaderStage::callable>;

}  // namespace rayloom
