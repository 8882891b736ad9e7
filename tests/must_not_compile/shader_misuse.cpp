// Misuses of the shader API: legality of intrinsics by stage (STG, SV), verdicts (AH, IS) and signatures (STG-11).

#include <rayloom/runtime/shader_library.h>

using namespace rayloom;

struct Payload {
  float4 color;
};
struct Attributes {
  float words[8];
};
using Barycentrics = BuiltInTriangleIntersectionAttributes;

#ifdef CASE_OK
#define OK_OR_BAD(ok, bad) ok
#else
#define OK_OR_BAD(ok, bad) bad
#endif

#if CASE == 1  // STG-01
void use(OK_OR_BAD(ClosestHitContext, AnyHitContext) & ctx, Payload& payload) {
  ctx.TraceRay({}, 0, 0xFF, 0, 0, 0, RayDesc{}, payload);
}
#elif CASE == 2   // STG-02
void use(OK_OR_BAD(MissContext, AnyHitContext) & ctx, Payload& payload) { ctx.CallShader(0, payload); }
#elif CASE == 3   // STG-03
bool use(OK_OR_BAD(IntersectionContext, ClosestHitContext) & ctx) {
  return ctx.ReportHit(1.0f, 0, Attributes{}).accepted();
}
#elif CASE == 4   // STG-04
AnyHitVerdict use(OK_OR_BAD(AnyHitContext, ClosestHitContext) & ctx) { return ctx.IgnoreHit(); }
#elif CASE == 5   // SV-08
uint use(OK_OR_BAD(ClosestHitContext, MissContext) & ctx) { return ctx.HitKind(); }
#elif CASE == 6   // SV-03
float use(OK_OR_BAD(MissContext, CallableContext) & ctx) { return ctx.RayTCurrent(); }
#elif CASE == 7   // an any-hit shader without a verdict
OK_OR_BAD(AnyHitVerdict, void) any_hit(AnyHitContext& ctx, Payload&, const Barycentrics&) {
  OK_OR_BAD(return ctx.AcceptHit(), static_cast<void>(ctx));
}
void use(ShaderLibrary& library) { library.AnyHit("any_hit", any_hit); }
#elif CASE == 8   // a dropped verdict
AnyHitVerdict any_hit(AnyHitContext& ctx, Payload&, const Barycentrics& attributes) {
  if (attributes.barycentrics.x > 0.5f) OK_OR_BAD(return, ) ctx.IgnoreHit();
  return ctx.AcceptHit();
}
#elif CASE == 9   // a verdict of no context
AnyHitVerdict any_hit(AnyHitContext& ctx, Payload&, const Barycentrics&) {
  static_cast<void>(ctx);
  return OK_OR_BAD(ctx.AcceptHit(), AnyHitVerdict());
}
#elif CASE == 10  // a dropped report
IntersectionVerdict intersection(IntersectionContext& ctx) {
  OK_OR_BAD(return, ) ctx.ReportHit(1.0f, 0, Attributes{});
  return ctx.EndIntersection();
}
#elif CASE == 11  // a payload by value would lose what the shader writes
void closest_hit(ClosestHitContext&, Payload OK_OR_BAD(&, ), const Barycentrics&) {}
void use(ShaderLibrary& library) { library.ClosestHit("closest_hit", closest_hit); }
#elif CASE == 12  // miss shaders have no attributes
#define COMMA ,
void miss(MissContext&, Payload& OK_OR_BAD(, COMMA const Barycentrics&)) {}
void use(ShaderLibrary& library) { library.Miss("miss", miss); }
#elif CASE == 13  // many lanes run one functor
struct Counting {
  uint count = 0;
  void operator()(RayGenContext&) OK_OR_BAD(const, ) {}
};
void use(ShaderLibrary& library) { library.RayGeneration("counting", Counting{}); }
#elif CASE == 14  // IS-13
struct Large {
  float words[OK_OR_BAD(8, 9)];
};
IntersectionVerdict intersection(IntersectionContext& ctx) { return ctx.ReportHit(1.0f, 0, Large{}); }
#elif CASE == 15  // an intersection shader without a verdict
OK_OR_BAD(IntersectionVerdict, void) intersection(IntersectionContext& ctx) {
  OK_OR_BAD(return ctx.EndIntersection(), static_cast<void>(ctx));
}
void use(ShaderLibrary& library) { library.Intersection("intersection", intersection); }
#elif CASE == 16  // a shader of another stage
void miss(MissContext&, Payload&) {}
void use(ShaderLibrary& library) { library.OK_OR_BAD(Miss, Callable)("miss", miss); }
#endif
