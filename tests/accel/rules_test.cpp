// Rows OP, RF, CU, EXT and TR of the checklist, on one primitive at a time.

#include <catch2/catch.hpp>

#include "recorder.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr float infinity = Box::infinity;
constexpr Ray upward{{0, 0, 0}, 0, {0, 0, 1}, infinity};

/// A triangle at z = 1 that shows its back to the origin: cross(v1 - v0, v2 - v0) is +z (CU-01).
Mesh facing_up() {
  Mesh mesh;
  mesh.add_triangle({-1, -1, 1}, {1, -1, 1}, {0, 2, 1});
  return mesh;
}

struct Aabb {
  float bounds[6];
};

AabbGeometry boxes_of(const std::vector<Aabb>& boxes, uint32_t flags) {
  return {reinterpret_cast<const std::byte*>(boxes.data()), sizeof(Aabb), boxes.size(), flags};
}

/// A bottom level of either kind over one primitive at z = 1, and a top level over it.
struct Scene {
  Scene(HitType type, uint32_t geometry_flags, uint32_t instance_flags, uint8_t mask = 0xFF)
      : bottom(type == HitType::triangle ? build_mesh(mesh, geometry_flags)
                                         : build_geometries(std::vector{boxes_of(boxes, geometry_flags)})),
        top(build_instances({described(instance_flags, mask)})) {}

  InstanceDesc described(uint32_t flags, uint8_t mask) const {
    InstanceDesc desc = instance_of(bottom);
    desc.flags = flags & 0xFF;
    desc.instance_mask = mask;
    return desc;
  }

  Mesh mesh = facing_up();
  std::vector<Aabb> boxes{{{-1, -1, 1, 1, 1, 2}}};
  Block bottom, top;
};

/// What became of the primitive: H committed without asking (a procedural is asked with `opaque`), A asked, C culled.
char cell(HitType type, uint32_t geometry_flags, uint32_t instance_flags, uint32_t ray_flags) {
  const Scene scene(type, geometry_flags, instance_flags);
  Recorder recorder([](const Candidate&) { return Verdict{true, false, 1.5f, 5}; });
  const Hit hit = trace({}, recorder.request(scene.top, upward, ray_flags));
  if (recorder.candidates.empty()) return hit ? 'H' : 'C';
  CHECK(hit);
  return type == HitType::procedural && recorder.candidates[0].opaque ? 'H' : 'A';
}

}  // namespace

TEST_CASE("opacity resolves as the table of OP-01 to OP-06 says, for triangles and procedurals (OP-10)") {
  struct Row {
    uint32_t geometry, instance;
    const char* cells;
  };
  const Row rows[] = {{geometry_flag::opaque, instance_flag::none, "HHACH"},
                      {geometry_flag::opaque, instance_flag::force_opaque, "HHACH"},
                      {geometry_flag::opaque, instance_flag::force_non_opaque, "AHAAC"},
                      {geometry_flag::none, instance_flag::none, "AHAAC"},
                      {geometry_flag::none, instance_flag::force_opaque, "HHACH"},
                      {geometry_flag::none, instance_flag::force_non_opaque, "AHAAC"}};
  const uint32_t columns[] = {ray_flag::none, ray_flag::force_opaque, ray_flag::force_non_opaque, ray_flag::cull_opaque,
                              ray_flag::cull_non_opaque};
  for_each_isa([&](Isa) {
    for (const HitType type : {HitType::triangle, HitType::procedural})
      for (const Row& row : rows)
        for (int column = 0; column < 5; ++column) {
          CAPTURE(int(type), row.geometry, row.instance, column);
          CHECK(cell(type, row.geometry, row.instance, columns[column]) == row.cells[column]);
        }
  });
}

TEST_CASE("facing, culling and their instance flags (CU-01, CU-04 to CU-07, RF-09)") {
  for (const bool from_behind : {false, true})
    for (const bool counterclockwise : {false, true})
      for (const bool disable : {false, true})
        for (const uint32_t cull :
             {ray_flag::none, ray_flag::cull_back_facing_triangles, ray_flag::cull_front_facing_triangles}) {
          const uint32_t flags = (counterclockwise ? instance_flag::triangle_front_counterclockwise : 0) |
                                 (disable ? instance_flag::triangle_cull_disable : 0);
          const Scene scene(HitType::triangle, geometry_flag::opaque, flags);
          const Ray ray = from_behind ? Ray{{0, 0, 2}, 0, {0, 0, -1}, infinity} : upward;
          const bool front = from_behind != counterclockwise;
          const bool culled = !disable && ((front && cull == ray_flag::cull_front_facing_triangles) ||
                                           (!front && cull == ray_flag::cull_back_facing_triangles));
          for_each_isa([&](Isa) {
            const Hit hit = trace({}, request_for(scene.top, ray, cull));
            CAPTURE(from_behind, counterclockwise, disable, cull);
            CHECK(bool(hit) == !culled);
            if (hit) CHECK(hit.hit_kind == (front ? hit_kind_triangle_front_face : hit_kind_triangle_back_face));
          });
        }
}

TEST_CASE("a mirrored instance keeps its facing, a mirrored geometry changes it (CU-02, CU-03)") {
  Scene scene(HitType::triangle, geometry_flag::opaque, 0);
  const Transform3x4 mirror{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const uint32_t kind = trace({}, request_for(scene.top, upward)).hit_kind;
  const Block mirrored = build_instances({instance_of(scene.bottom, mirror)});
  CHECK(trace({}, request_for(mirrored, upward)).hit_kind == kind);

  TriangleGeometry geometry = scene.mesh.geometry();
  geometry.transform = mirror.data();
  const Block baked = build_geometries(std::vector{geometry});
  CHECK(trace({}, request_for(baked, upward)).hit_kind == (kind ^ 1u));
}

TEST_CASE("facing culls leave procedurals alone and farther hits reachable (RF-09, CU-07)") {
  const Scene box(HitType::procedural, geometry_flag::opaque, 0);
  Recorder recorder([](const Candidate&) { return Verdict{true, false, 1.5f, 5}; });
  const uint32_t both = ray_flag::cull_back_facing_triangles | ray_flag::cull_front_facing_triangles;
  CHECK(trace({}, recorder.request(box.top, upward, both)));

  Mesh two = facing_up();
  two.add_triangle({-1, -1, 3}, {0, 2, 3}, {1, -1, 3});
  const Block block = build_mesh(two);
  CHECK(trace({}, request_for(block, upward, ray_flag::cull_back_facing_triangles)).t == 3);
  CHECK(trace({}, request_for(block, upward, ray_flag::cull_front_facing_triangles)).t == 1);
}

TEST_CASE("SKIP flags drop one kind of primitive, cull-disable or not (RF-14, RF-15)") {
  const Scene triangle(HitType::triangle, geometry_flag::opaque, instance_flag::triangle_cull_disable);
  const Scene box(HitType::procedural, geometry_flag::opaque, instance_flag::triangle_cull_disable);
  for (const bool skip_triangles : {false, true})
    for (const bool skip_boxes : {false, true}) {
      const uint32_t flags =
          (skip_triangles ? ray_flag::skip_triangles : 0) | (skip_boxes ? ray_flag::skip_procedural_primitives : 0);
      for (const bool direct : {false, true}) {
        Recorder recorder([](const Candidate&) { return Verdict{true, false, 1.5f, 5}; });
        CHECK(bool(trace({}, recorder.request(direct ? triangle.bottom : triangle.top, upward, flags))) ==
              !skip_triangles);
        CHECK(bool(trace({}, recorder.request(direct ? box.bottom : box.top, upward, flags))) == !skip_boxes);
      }
    }
}

TEST_CASE("instance masks (TR-11, TR-12)") {
  for (const uint32_t mask : {0x00u, 0x01u, 0x80u, 0xFFu}) {
    const Scene scene(HitType::triangle, geometry_flag::opaque, 0, static_cast<uint8_t>(mask));
    for (const uint32_t inclusion : {0x00u, 0x01u, 0x80u, 0xFFu, 0x100u, 0x101u}) {
      TraceRequest request = request_for(scene.top, upward);
      request.instance_mask = inclusion;
      CAPTURE(mask, inclusion);
      CHECK(bool(trace({}, request)) == ((mask & inclusion & 0xFF) != 0));
    }
  }
}

TEST_CASE("procedural hits count at both ends of the interval (EXT-02, EXT-05, BB-02, BB-05)") {
  const Scene scene(HitType::procedural, geometry_flag::opaque, 0);  // the box spans z = 1..2
  const auto report = [&](float t_min, float t_max, float t) {
    Recorder recorder([t](const Candidate&) { return Verdict{true, false, t, 5}; });
    const Hit hit = trace({}, recorder.request(scene.top, {{0, 0, 0}, t_min, {0, 0, 1}, t_max}));
    if (hit) CHECK((hit.t == t && hit.hit_kind == 5 && hit.type == HitType::procedural));
    return std::pair{recorder.candidates.size(), bool(hit)};
  };
  for_each_isa([&](Isa) {
    CHECK(report(1.25f, 9, 1.25f) == std::pair{size_t{1}, true});
    CHECK(report(0, 1.5f, 1.5f) == std::pair{size_t{1}, true});
    CHECK(report(1.5f, 1.5f, 1.5f) == std::pair{size_t{1}, true});
    CHECK(report(0, 1, 1) == std::pair{size_t{1}, true});
    CHECK(report(2, 9, 2) == std::pair{size_t{1}, true});
    CHECK(report(1.5f, 9, 1.25f).second == false);
    CHECK(report(0, 1.5f, 1.75f).second == false);
    CHECK(report(0, 9, std::numeric_limits<float>::quiet_NaN()).second == false);
    CHECK(report(0, 9, 7) == std::pair{size_t{1}, true});  // outside the box
    CHECK(report(0, 0.5f, 0.5f).first == 0);
    CHECK(report(3, 9, 3).first == 0);
  });
}

TEST_CASE("equal t: procedural beats triangle, the larger of two procedurals wins (EXT-03, EXT-04, G3b)") {
  const Mesh mesh = facing_up();
  const std::vector<Aabb> one{{{-1, -1, 0.5f, 1, 1, 1.5f}}}, three(3, one[0]);
  const Block triangle = build_mesh(mesh), box = build_geometries(std::vector{boxes_of(one, 1)}),
              boxes = build_geometries(std::vector{boxes_of(three, 1)});
  const auto at_one = [](const Candidate&) { return Verdict{true, false, 1, 5}; };
  for_each_isa([&](Isa) {
    for (const bool box_first : {false, true}) {
      const Block top =
          build_instances({instance_of(box_first ? box : triangle), instance_of(box_first ? triangle : box)});
      Recorder recorder(at_one);
      CHECK(trace({}, recorder.request(top, upward)).type == HitType::procedural);
    }
    Recorder up(at_one);
    CHECK(trace({}, up.request(boxes, upward)).primitive_index == 2);
    const Block top = build_instances({instance_of(boxes), instance_of(boxes)});
    Recorder all(at_one);
    const Hit hit = trace({}, all.request(top, upward));
    CHECK((hit.instance_index == 1 && hit.primitive_index == 2));
    // The caller knows beforehand which reports at t_current traversal takes: those that raise the name.
    std::pair<uint32_t, uint32_t> committed{0, 0};
    for (const Candidate& c : all.candidates) {
      const std::pair name{c.instance_index, c.primitive_index};
      CHECK(c.wins_ties == (name >= committed));
      committed = std::max(committed, name);
    }
  });
}

TEST_CASE("a triangle at exactly t_max misses where a procedural hits, before and after commits") {
  const Mesh mesh = facing_up();
  const Block triangle = build_mesh(mesh);
  CHECK(!trace({}, request_for(triangle, {{0, 0, 0}, 0, {0, 0, 1}, 1})));
  const Scene box(HitType::procedural, geometry_flag::opaque, 0);
  Recorder recorder([](const Candidate& c) { return Verdict{true, false, c.t_current, 5}; });
  CHECK(trace({}, recorder.request(box.top, {{0, 0, 0}, 0, {0, 0, 1}, 1})));
}

TEST_CASE("rays from inside, flat boxes and axis-parallel rays reach procedurals (BB-04, BB-07, PR-13)") {
  const std::vector<Aabb> flat{{{-1, -1, 1, 1, 1, 1}}, {{-1, 0, 0, 1, 0, 4}}, {{0, 0, 0, 0, 0, 4}}};
  for_each_isa([&](Isa) {
    for (const Aabb& box : flat) {
      const std::vector<Aabb> one{box};
      const Block block = build_geometries(std::vector{boxes_of(one, 1)});
      for (const float zero : {0.0f, -0.0f}) {
        Recorder recorder;
        trace({}, recorder.request(block, {{0, 0, 0.5f}, 0, {zero, zero, 1}, infinity}));
        CHECK(recorder.candidates.size() == 1);
      }
    }
    const std::vector<Aabb> one{{{-1, -1, -1, 1, 1, 1}}};
    const Block block = build_geometries(std::vector{boxes_of(one, 1)});
    for (int i = 0; i < 27; ++i) {
      const float d[3] = {float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 - 1)};
      if (i == 13) continue;
      Recorder inside, outside, on_face;
      trace({}, inside.request(block, {{0, 0, 0}, 0, {d[0], d[1], d[2]}, infinity}));
      trace({}, outside.request(block, {{-3 * d[0], -3 * d[1], -3 * d[2]}, 0, {d[0], d[1], d[2]}, infinity}));
      CHECK(inside.candidates.size() == 1);
      CHECK(outside.candidates.size() == 1);
    }
  });
}
