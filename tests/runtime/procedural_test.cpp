// Rows IS, EXT-02..05, CM-03: intersection shaders and what they report.

#include "program.h"
#include "reference_tracer.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace rayloom;
using namespace rayloom::test;

namespace {

struct Wide {
  uint words[8];
};

/// One box whose intersection shader is given; logs any-hit and closest-hit attributes.
template <class Intersection>
DispatchStatistics run_box(Program& program, Buffer& log, Intersection intersection, bool opaque = true,
                           uint flags = RAY_FLAG_NONE, uint any_hit_decision = 0) {
  log = program.counters();
  const auto out = log.rw_structured<uint>();
  const auto scene =
      program.scene(program.boxes({1}, opaque ? RAYTRACING_GEOMETRY_FLAG_OPAQUE : RAYTRACING_GEOMETRY_FLAG_NONE));
  program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
    Value payload{0};
    RayDesc ray = straight_ray();
    ray.TMin = 1;
    ctx.TraceRay(scene, flags, 0xFF, 0, 0, 0, ray, payload);
  });
  program.shaders.Intersection("is", [=](IntersectionContext& ctx) { return intersection(ctx, out); });
  program.shaders.AnyHit("ah", [=](AnyHitContext& ctx, Value&, const Wide& wide) {
    InterlockedAdd(out[20], 1);
    out[21] = wide.words[7];
    out[22] = ctx.HitKind();
    if (any_hit_decision == 1) return ctx.IgnoreHit();
    return any_hit_decision == 2 ? ctx.AcceptHitAndEndSearch() : ctx.AcceptHit();
  });
  program.shaders.ClosestHit("ch", [out](ClosestHitContext& ctx, Value&, const Wide& wide) {
    out[30] = wide.words[0];
    out[31] = wide.words[7];
    out[32] = ctx.HitKind();
    out[33] = uint(ctx.RayTCurrent());
  });
  program.hit_group("hg", "ch", "ah", "is");
  program.create("rg", {""}, {"hg"});
  return program.run().statistics;
}

using Out = RWStructuredBuffer<uint>;

}  // namespace

TEST_CASE("IS-09, IS-10: reports 5, 3, 4 are accepted, accepted, refused") {
  Program program;
  Buffer log;
  run_box(program, log, [](IntersectionContext& ctx, Out out) {
    const ReportHitResult a = ctx.ReportHit(5.0f, 1, Wide{{5, 0, 0, 0, 0, 0, 0, 50}});
    const ReportHitResult b = ctx.ReportHit(3.0f, 2, Wide{{3, 0, 0, 0, 0, 0, 0, 30}});
    const ReportHitResult c = ctx.ReportHit(4.0f, 3, Wide{{4, 0, 0, 0, 0, 0, 0, 40}});
    out[0] = a.accepted() * 100u + b.accepted() * 10u + c.accepted();
    return c;
  });
  CHECK(log.as<uint>()[0] == 110);
  CHECK(log.download<uint>(4, 30 * 4) == std::vector<uint>{3, 30, 2, 3});
}

TEST_CASE("EXT-02, EXT-03, IS-04: the range is closed, and of equal reports the later wins") {
  Program program;
  Buffer log;
  run_box(program, log, [](IntersectionContext& ctx, Out out) {
    out[0] = bool(ctx.ReportHit(100.0f, 0, Wide{}));
    out[1] = bool(ctx.ReportHit(100.5f, 0, Wide{}));
    out[2] = bool(ctx.ReportHit(0.5f, 0, Wide{}));
    out[3] = bool(ctx.ReportHit(2.0f, 0, Wide{{1}}));
    out[4] = bool(ctx.ReportHit(2.0f, 7, Wide{{2}}));
    out[5] = bool(ctx.ReportHit(1.0f, 8, Wide{{3}}));
    return ctx.EndIntersection();
  });
  CHECK(log.download<uint>(6) == std::vector<uint>{1, 0, 0, 1, 1, 1});
  CHECK(log.as<uint>()[32] == 8);
}

TEST_CASE("IS-11: attributes are copied at the call") {
  Program program;
  Buffer log;
  run_box(
      program, log,
      [](IntersectionContext& ctx, Out) {
        Wide wide{{11, 0, 0, 0, 0, 0, 0, 77}};
        const ReportHitResult result = ctx.ReportHit(2.0f, 0, wide);
        wide = {};
        return result;
      },
      false);
  CHECK(log.as<uint>()[21] == 77);
  CHECK(log.as<uint>()[30] == 11);
}

TEST_CASE("IS-12, IS-18: hit kinds above 127 and NaN are refused and reported") {
  Program program;
  Buffer log;
  run_box(program, log, [](IntersectionContext& ctx, Out out) {
    out[0] = bool(ctx.ReportHit(2.0f, 128, Wide{}));
    out[1] = bool(ctx.ReportHit(2.0f, 254, Wide{}));
    out[2] = bool(ctx.ReportHit(std::numeric_limits<float>::quiet_NaN(), 0, Wide{}));
    out[3] = bool(ctx.ReportHit(2.0f, 127, Wide{}));
    out[4] = bool(ctx.ReportHit(2.0f, 0, Wide{}));
    return ctx.EndIntersection();
  });
  CHECK(log.download<uint>(5) == std::vector<uint>{0, 0, 0, 1, 1});
  CHECK(program.reported("IS-12"));
  CHECK(program.reported("IS-18"));
}

TEST_CASE("IS-06: any-hit runs inside ReportHit; an ignored report is refused") {
  Program program;
  Buffer log;
  const DispatchStatistics statistics = run_box(
      program, log,
      [](IntersectionContext& ctx, Out out) {
        const ReportHitResult result = ctx.ReportHit(2.0f, 9, Wide{{0, 0, 0, 0, 0, 0, 0, 6}});
        out[0] = result.accepted();
        out[1] = out[20];
        out[2] = uint(ctx.RayTCurrent());
        return result;
      },
      false, 0, 1);
  CHECK(log.download<uint>(3) == std::vector<uint>{0, 1, 100});
  CHECK(log.as<uint>()[22] == 9);
  CHECK(statistics.hits == 0);
}

TEST_CASE("IS-07: after the search has ended nothing more is heard, even if the shader goes on") {
  for (const bool by_flag : {true, false}) {
    Program program;
    Buffer log;
    const DispatchStatistics statistics = run_box(
        program, log,
        [](IntersectionContext& ctx, Out out) {
          const ReportHitResult first = ctx.ReportHit(4.0f, 1, Wide{{4}});
          out[0] = first.search_ended();
          const ReportHitResult second = ctx.ReportHit(2.0f, 2, Wide{{2}});
          out[1] = second.accepted();
          out[2] = second.search_ended();
          return ctx.EndIntersection();
        },
        false, by_flag ? RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH : RAY_FLAG_NONE, by_flag ? 0 : 2);
    CHECK(log.download<uint>(3) == std::vector<uint>{1, 0, 1});
    CHECK(statistics.any_hit == 1);
    CHECK(log.as<uint>()[30] == 4);
    CHECK(log.as<uint>()[33] == 4);
  }
}

TEST_CASE("IS-08: returning ends the shader with its destructors") {
  struct Probe {
    Out out;
    ~Probe() { out[5] = 1; }
  };
  Program program;
  Buffer log;
  run_box(
      program, log,
      [](IntersectionContext& ctx, Out out) -> IntersectionVerdict {
        const Probe probe{out};
        if (ReportHitResult result = ctx.ReportHit(4.0f, 1, Wide{}); result.search_ended()) return result;
        out[6] = 1;
        return ctx.EndIntersection();
      },
      false, 0, 2);
  CHECK(log.as<uint>()[5] == 1);
  CHECK(log.as<uint>()[6] == 0);
}

TEST_CASE("IS-14: attributes of another type run neither any-hit nor closest-hit") {
  Program program;
  Buffer log;
  const DispatchStatistics statistics = run_box(
      program, log, [](IntersectionContext& ctx, Out) { return ctx.ReportHit(2.0f, 0, Value{}); }, false);
  CHECK(statistics.hits == 1);
  CHECK(statistics.any_hit + statistics.closest_hit == 0);
  CHECK(program.reported("IS-14"));
}

TEST_CASE("EXT-04, G3b: procedural and triangle at one t; of two procedurals the later one in name") {
  for (const bool triangle_first : {true, false}) {
    Program program;
    const Buffer log = program.counters();
    const auto out = log.rw_structured<uint>();
    RAYTRACING_INSTANCE_DESC triangle = instance(program.layers({1}));
    RAYTRACING_INSTANCE_DESC boxes = instance(program.boxes({1, 1, 1}));
    boxes.InstanceContributionToHitGroupIndex = 1;
    const auto scene = triangle_first ? program.scene({triangle, boxes}) : program.scene({boxes, triangle});
    program.shaders.RayGeneration("rg", [=](RayGenContext& ctx) {
      Value payload{0};
      ctx.TraceRay(scene, 0, 0xFF, 0, 0, 0, straight_ray(), payload);
      out[0] = payload.value;
    });
    program.shaders.Intersection(
        "is", [](IntersectionContext& ctx) { return ctx.ReportHit(2.0f, 0, Value{10 + ctx.GeometryIndex()}); });
    program.shaders.ClosestHit("triangle",
                               [](ClosestHitContext&, Value& payload, const Barycentrics&) { payload.value = 1; });
    program.shaders.ClosestHit("box", [](ClosestHitContext& ctx, Value& payload, const Value& attributes) {
      payload.value = attributes.value * 10 + ctx.GeometryIndex();
    });
    program.hit_group("t", "triangle").hit_group("b", "box", "", "is");
    program.create("rg", {""}, {"t", "b"});
    program.run();
    CHECK(log.as<uint>()[0] == 122);
  }
}
