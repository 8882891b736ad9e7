// Rows STG-01..04, SV-01..08: the whole table of intrinsics and system values by stage, checked when this compiles.

#include <rayloom/runtime/rayloom.h>

#include <array>
#include <catch2/catch.hpp>

using namespace rayloom;

namespace {

struct Data {
  uint value;
};

template <class C>
concept Traces = requires(C& ctx, Data& data) {
  ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, RayDesc{}, data);
};
template <class C>
concept Calls = requires(C& ctx, Data& data) {
  ctx.CallShader(0, data);
};
template <class C>
concept Reports = requires(C& ctx) {
  ctx.ReportHit(1.0f, 0, Data{});
};
template <class C>
concept Decides = requires(C& ctx) {
  ctx.IgnoreHit();
};

template <bool... legal>
inline constexpr std::array<bool, 6> row = {legal...};

/// One row: is the call legal in RG, IS, AH, CH, MS, CA?
#define RAYLOOM_ROW(test, ...)                                                                                    \
  template <class C>                                                                                              \
  concept test##_value = requires(const C& ctx) {                                                                 \
    ctx.test();                                                                                                   \
  };                                                                                                              \
  static_assert(row<test##_value<RayGenContext>, test##_value<IntersectionContext>, test##_value<AnyHitContext>,  \
                    test##_value<ClosestHitContext>, test##_value<MissContext>, test##_value<CallableContext>> == \
                std::array<bool, 6>{__VA_ARGS__})

static_assert(row<Traces<RayGenContext>, Traces<IntersectionContext>, Traces<AnyHitContext>, Traces<ClosestHitContext>,
                  Traces<MissContext>, Traces<CallableContext>> == std::array{true, false, false, true, true, false});
static_assert(row<Calls<RayGenContext>, Calls<IntersectionContext>, Calls<AnyHitContext>, Calls<ClosestHitContext>,
                  Calls<MissContext>, Calls<CallableContext>> == std::array{true, false, false, true, true, true});
static_assert(row<Reports<RayGenContext>, Reports<IntersectionContext>, Reports<AnyHitContext>,
                  Reports<ClosestHitContext>, Reports<MissContext>, Reports<CallableContext>> ==
              std::array{false, true, false, false, false, false});
static_assert(row<Decides<RayGenContext>, Decides<IntersectionContext>, Decides<AnyHitContext>,
                  Decides<ClosestHitContext>, Decides<MissContext>, Decides<CallableContext>> ==
              std::array{false, false, true, false, false, false});

// clang-format off
//                                     RG     IS     AH     CH     MS     CA
RAYLOOM_ROW(DispatchRaysIndex,         true,  true,  true,  true,  true,  true);
RAYLOOM_ROW(DispatchRaysDimensions,    true,  true,  true,  true,  true,  true);
RAYLOOM_ROW(WorldRayOrigin,            false, true,  true,  true,  true,  false);
RAYLOOM_ROW(WorldRayDirection,         false, true,  true,  true,  true,  false);
RAYLOOM_ROW(RayTMin,                   false, true,  true,  true,  true,  false);
RAYLOOM_ROW(RayTCurrent,               false, true,  true,  true,  true,  false);
RAYLOOM_ROW(RayFlags,                  false, true,  true,  true,  true,  false);
RAYLOOM_ROW(InstanceIndex,             false, true,  true,  true,  false, false);
RAYLOOM_ROW(InstanceID,                false, true,  true,  true,  false, false);
RAYLOOM_ROW(GeometryIndex,             false, true,  true,  true,  false, false);
RAYLOOM_ROW(PrimitiveIndex,            false, true,  true,  true,  false, false);
RAYLOOM_ROW(ObjectRayOrigin,           false, true,  true,  true,  false, false);
RAYLOOM_ROW(ObjectRayDirection,        false, true,  true,  true,  false, false);
RAYLOOM_ROW(ObjectToWorld3x4,          false, true,  true,  true,  false, false);
RAYLOOM_ROW(ObjectToWorld4x3,          false, true,  true,  true,  false, false);
RAYLOOM_ROW(WorldToObject3x4,          false, true,  true,  true,  false, false);
RAYLOOM_ROW(WorldToObject4x3,          false, true,  true,  true,  false, false);
RAYLOOM_ROW(HitKind,                   false, false, true,  true,  false, false);
// clang-format on

// STG-11 and the verdict types.
[[maybe_unused]] void closest_hit(ClosestHitContext&, Data&, const Data&) {}
[[maybe_unused]] void miss(MissContext&, Data&) noexcept {}
static_assert(ClosestHitShader<decltype(&closest_hit)> && !MissShader<decltype(&closest_hit)>);
static_assert(MissShader<decltype(&miss)> && !CallableShader<decltype(&miss)>);
static_assert(!RayGenerationShader<int> && !RayGenerationShader<decltype([](auto&) {})>);
static_assert(!std::is_default_constructible_v<AnyHitVerdict> &&
              !std::is_default_constructible_v<IntersectionVerdict> &&
              !std::is_default_constructible_v<ReportHitResult>);
static_assert(!std::is_constructible_v<AnyHitVerdict, detail::HitDecision>);
static_assert(!std::is_copy_constructible_v<AnyHitContext>);

}  // namespace

TEST_CASE("CAP-11: enum values that shaders and files carry") {
  CHECK(HIT_KIND_TRIANGLE_FRONT_FACE == 254);
  CHECK(HIT_KIND_TRIANGLE_BACK_FACE == 255);
  uint all = 0, bit = 1;
  for (const uint flag :
       {RAY_FLAG_FORCE_OPAQUE, RAY_FLAG_FORCE_NON_OPAQUE, RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH,
        RAY_FLAG_SKIP_CLOSEST_HIT_SHADER, RAY_FLAG_CULL_BACK_FACING_TRIANGLES, RAY_FLAG_CULL_FRONT_FACING_TRIANGLES,
        RAY_FLAG_CULL_OPAQUE, RAY_FLAG_CULL_NON_OPAQUE, RAY_FLAG_SKIP_TRIANGLES, RAY_FLAG_SKIP_PROCEDURAL_PRIMITIVES}) {
    CHECK(flag == bit);
    all |= flag;
    bit <<= 1;
  }
  CHECK(all == defined_ray_flags);
}
