// TopLevel::asks(): whether a ray with these flags can meet a candidate, against the rules applied primitive by
// primitive.

#include <rayloom/runtime/structure_cache.h>

#include "program.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::test;
using namespace rayloom::accel::ray_flag;
using detail::StructureCache;
using detail::TopLevel;

namespace {

enum class Kind { opaque_triangle, non_opaque_triangle, procedural };

/// RF-03 to RF-12, in the order of the specification; procedurals always run their intersection shader.
bool is_candidate(Kind kind, uint32_t flags) {
  if (kind == Kind::procedural) return !(flags & skip_procedural_primitives);
  if (flags & skip_triangles) return false;
  bool opaque = kind == Kind::opaque_triangle;
  if (flags & force_opaque)
    opaque = true;
  else if (flags & force_non_opaque)
    opaque = false;
  return !opaque && !(flags & cull_non_opaque);
}

constexpr uint32_t all_flags = 0x400;

/// Flags for which `scene` answers otherwise than its primitives taken one by one.
std::vector<uint32_t> wrong_answers(const TopLevel& scene, const std::vector<Kind>& primitives) {
  std::vector<uint32_t> wrong;
  for (uint32_t flags = 0; flags < all_flags; ++flags) {
    const bool expected =
        std::any_of(primitives.begin(), primitives.end(), [flags](Kind kind) { return is_candidate(kind, flags); });
    if (scene.asks(flags) != expected) wrong.push_back(flags);
  }
  return wrong;
}

TopLevel found(Program& program, const std::vector<RAYTRACING_INSTANCE_DESC>& instances) {
  StructureCache cache(program.device.memory());
  return cache.find(program.scene(instances).address);
}

RAYTRACING_INSTANCE_DESC flagged(const AccelerationStructure& bottom_level, uint32_t flags) {
  RAYTRACING_INSTANCE_DESC desc = instance(bottom_level);
  desc.Flags = flags & 0xFFu;
  return desc;
}

}  // namespace

TEST_CASE("asks() of built scenes: flags of geometry and instance, all flags of a ray") {
  Program program;
  const auto& opaque = program.layers({0, 1});
  const auto& mixed = program.layers({0, 1}, {RAYTRACING_GEOMETRY_FLAG_OPAQUE, RAYTRACING_GEOMETRY_FLAG_NONE});
  const auto& boxes = program.boxes({0});
  const auto same = [&](const std::vector<RAYTRACING_INSTANCE_DESC>& instances, const std::vector<Kind>& primitives) {
    return wrong_answers(found(program, instances), primitives) == std::vector<uint32_t>{};
  };
  const Kind solid = Kind::opaque_triangle, open = Kind::non_opaque_triangle, box = Kind::procedural;
  CHECK(same({instance(opaque)}, {solid}));
  CHECK(same({instance(mixed)}, {solid, open}));
  CHECK(same({instance(opaque), instance(mixed)}, {solid, open}));
  CHECK(same({flagged(mixed, RAYTRACING_INSTANCE_FLAG_FORCE_OPAQUE)}, {solid}));
  CHECK(same({flagged(opaque, RAYTRACING_INSTANCE_FLAG_FORCE_NON_OPAQUE)}, {open}));
  CHECK(same({instance(opaque), instance(boxes)}, {solid, box}));
  CHECK(same({instance(mixed), instance(boxes)}, {open, box}));
  CHECK(same({instance(mixed), flagged(opaque, RAYTRACING_INSTANCE_FLAG_FORCE_OPAQUE)}, {open}));
}

TEST_CASE("asks() of procedurals alone may err on the side of asking, never on the other") {
  Program program;
  const TopLevel scene = found(program, {instance(program.boxes({0}))});
  for (uint32_t flags = 0; flags < all_flags; ++flags) {
    CAPTURE(flags);
    if (is_candidate(Kind::procedural, flags)) CHECK(scene.asks(flags));
    if (!(flags & force_non_opaque)) CHECK(scene.asks(flags) == is_candidate(Kind::procedural, flags));
  }
}
