#include <rayloom/accel/instance_transform.h>

#include <catch2/catch.hpp>

#include "brute_force.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

/// A transform with a random rotation-like part: random entries, columns scaled, translation up to `reach`.
Transform3x4 random_affine(Random& random, int scale_exponent, float reach) {
  Transform3x4 m;
  for (int column = 0; column < 3; ++column) {
    const float scale = std::abs(random.scaled(-scale_exponent, scale_exponent + 1));
    for (int row = 0; row < 3; ++row) m[4 * row + column] = random.uniform(-1, 1) * scale;
  }
  for (int row = 0; row < 3; ++row) m[4 * row + 3] = random.uniform(-reach, reach);
  return m;
}

/// Makes the columns nearly dependent: conditioning about 1 / gap.
Transform3x4 nearly_singular(Transform3x4 m, float gap) {
  for (int row = 0; row < 3; ++row) m[4 * row + 1] = m[4 * row] + gap * m[4 * row + 1];
  return m;
}

Point transformed(const Transform3x4& m, const Point& p) {
  Point out;
  for (int row = 0; row < 3; ++row)
    out[row] = m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
  return out;
}

InstanceRecord record_of(const Transform3x4& m) {
  InstanceRecord record{};
  std::memcpy(record.object_to_world, m.data(), sizeof(m));
  const auto inverse = invert(record.object_to_world);
  REQUIRE(inverse);
  std::memcpy(record.world_to_object, inverse->matrix, sizeof(inverse->matrix));
  return record;
}

/// O1 over two levels: every triangle of every instance with that instance's own object-space ray.
std::vector<Hit> all_instance_hits(const std::vector<NamedTriangle>& triangles,
                                   const std::vector<Transform3x4>& transforms, const Ray& ray) {
  std::vector<Hit> hits;
  for (uint32_t i = 0; i < transforms.size(); ++i) {
    const auto part = all_hits(triangles, object_ray(record_of(transforms[i]), ray), i);
    hits.insert(hits.end(), part.begin(), part.end());
  }
  return hits;
}

/// Top level over `transforms` of one mesh against brute force, for rays from around the scene at the meshes' vertices.
void compare(const Mesh& mesh, const std::vector<Transform3x4>& transforms, size_t rays, uint64_t seed,
             uint32_t build_flags) {
  const Block bottom = build_mesh(mesh, geometry_flag::none);
  std::vector<InstanceDesc> descs;
  for (const auto& m : transforms) descs.push_back(instance_of(bottom, m));
  const Block top = build_instances(descs, build_flags);
  const auto triangles = all_triangles({mesh.geometry()});
  Random random(seed);
  for_each_isa([&](Isa) {
    size_t different = 0, culled = 0, hit_rays = 0;
    for (size_t i = 0; i < rays; ++i) {
      const auto& m = transforms[random.below(uint32_t(transforms.size()))];
      const Point to = transformed(m, mesh.vertices[random.below(uint32_t(mesh.vertices.size()))]);
      Point from = transformed(transforms[random.below(uint32_t(transforms.size()))], {0, 0, 0});
      if (random.chance(2))
        for (float& x : from) x += random.uniform(-3, 3) * std::abs(x - to[0]);
      const Ray ray = ray_between(from, to);
      const auto expected = all_instance_hits(triangles, transforms, ray);
      Recorder recorder;
      trace({}, recorder.request(top, ray));
      culled += recorder.candidates.size() != expected.size();
      different += !same_bits(trace({}, request_for(top, ray)), closest_of(expected, ray));
      hit_rays += !expected.empty();
    }
    CHECK(culled == 0);
    CHECK(different == 0);
    CHECK(hit_rays > rays / 4);
  });
}

/// The same for instances whose boxes fit more and less closely (close_box.h).
void compare(const Mesh& mesh, const std::vector<Transform3x4>& transforms, size_t rays, uint64_t seed) {
  for (const uint32_t flags : {build_flag::prefer_fast_build, build_flag::prefer_fast_trace})
    compare(mesh, transforms, rays, seed, flags);
}

/// Rays from `distance` away at a triangle in one instance, aimed beside it by what rounding the object-space ray can
/// make of them: the candidates must be those of brute force. Adds to `culled` and `hits`.
void graze(const Mesh& mesh, const Transform3x4& m, float distance, float stray, Random& random, size_t& culled,
           size_t& hits) {
  const Block bottom = build_mesh(mesh, geometry_flag::none);
  const Block top = build_instances({instance_of(bottom, m)});
  const auto triangles = all_triangles({mesh.geometry()});
  for (int i = 0; i < 20; ++i) {
    Point to = transformed(m, mesh.vertices[random.below(3)]), from = to;
    for (float& x : to) x += random.uniform(-stray, stray);
    for (float& x : from) x += random.uniform(-distance, distance);
    const Ray ray = ray_between(from, to);
    Recorder recorder;
    trace({}, recorder.request(top, ray));
    const size_t expected = all_instance_hits(triangles, {m}, ray).size();
    culled += recorder.candidates.size() != expected;
    hits += expected;
  }
}

Mesh small_triangle(const Point& centre, float size, Random& random) {
  const auto near = [&] {
    Point p = centre;
    for (float& x : p) x += random.uniform(-size, size);
    return p;
  };
  Mesh mesh;
  mesh.add_triangle(near(), near(), near());
  return mesh;
}

}  // namespace

TEST_CASE("transforms exact in float keep every bit of a hit (numerics T1)") {
  const Mesh mesh = bumpy_sphere(2);
  const Block bottom = build_mesh(mesh);
  const Transform3x4 exact[] = {identity_transform,
                                {0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0},
                                {0, 0, -1, 0, 1, 0, 0, 0, 0, -1, 0, 0},
                                {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0},
                                {0.125f, 0, 0, 0, 0, 0.125f, 0, 0, 0, 0, 0.125f, 0},
                                {8, 0, 0, 0, 0, -0.5f, 0, 0, 0, 0, 2, 0}};
  Random random(21);
  for (const auto& m : exact) {
    const Block top = build_instances({instance_of(bottom, m)});
    for_each_isa([&](Isa) {
      size_t different = 0, hits = 0;
      for (int i = 0; i < 400; ++i) {
        const auto any = [&] { return random.uniform(-1.5f, 1.5f); };
        const Ray object = ray_between({any(), any(), any()}, {any(), any(), any()});
        Ray world = object;
        for (int row = 0; row < 3; ++row) {
          world.origin[row] = world.direction[row] = 0;
          for (int k = 0; k < 3; ++k) {
            world.origin[row] += m[4 * row + k] * object.origin[k];
            world.direction[row] += m[4 * row + k] * object.direction[k];
          }
        }
        const Hit hit = trace({}, request_for(top, world));
        different += !same_bits(hit, trace({}, request_for(bottom, object)));
        hits += bool(hit);
      }
      CHECK(different == 0);
      CHECK(hits > 100);
    });
  }
}

TEST_CASE("two levels equal brute force over instances, well conditioned") {
  Random random(22);
  std::vector<Transform3x4> transforms;
  for (int i = 0; i < 30; ++i) transforms.push_back(random_affine(random, 3, 10));
  compare(bumpy_sphere(1), transforms, 400, 23);
}

TEST_CASE("two levels equal brute force, far away and tiny") {
  Random random(24);
  std::vector<Transform3x4> transforms;
  for (int i = 0; i < 20; ++i) transforms.push_back(random_affine(random, 10, 1e5f));
  compare(icosphere(1), transforms, 300, 25);
  compare(moved(icosphere(1), 1, 1000), transforms, 300, 26);
}

TEST_CASE("two levels equal brute force, ill conditioned") {
  Random random(27);
  for (const float gap : {1e-2f, 1e-4f, 1e-6f}) {
    std::vector<Transform3x4> transforms;
    for (int i = 0; i < 10; ++i) {
      const auto m = nearly_singular(random_affine(random, 2, 100), gap);
      InstanceDesc desc{};
      std::memcpy(desc.transform, m.data(), sizeof(m));
      if (invert(desc.transform)) transforms.push_back(m);
    }
    for (int i = 0; i < 5; ++i) transforms.push_back(random_affine(random, 1, 100));
    compare(icosphere(1), transforms, 200, 28);
  }
}

TEST_CASE("a badly conditioned transform's stray rays lose no hit") {
  Random random(30);
  for (const float gap : {0.03f, 1e-3f, 1e-5f}) {  // below and above the conditioning that the pad covers
    size_t culled = 0, hits = 0;
    for (int round = 0; round < 1500; ++round) {
      const auto m = nearly_singular(random_affine(random, 1, 10), gap);
      const float stray = 0x1p-24f * 300 / gap;
      graze(small_triangle({0, 0, 0}, stray, random), m, 300, stray, random, culled, hits);
    }
    CAPTURE(gap);
    CHECK(culled == 0);
    CHECK(hits > 500);
  }
}

TEST_CASE("geometry far from its instance's origin loses no hit to stray rays") {
  Random random(31);
  size_t culled = 0, hits = 0;
  for (int round = 0; round < 3000; ++round) {
    const Point centre{random.scaled(8, 14), random.scaled(8, 14), random.scaled(8, 14)};
    auto m = random_affine(random, 1, 0);
    const Point placed = transformed(m, centre);
    for (int row = 0; row < 3; ++row) m[4 * row + 3] = -placed[row];  // near the world's origin again
    graze(small_triangle(centre, 2e-3f, random), m, 0.01f, 2e-3f, random, culled, hits);
  }
  CHECK(culled == 0);
  CHECK(hits > 500);
}

TEST_CASE("a closed mesh in an instance does not leak (numerics T2)") {
  const Mesh mesh = icosphere(2);
  const Block bottom = build_mesh(mesh, geometry_flag::none);
  Random random(29);
  for (int i = 0; i < 60; ++i) {
    auto m = random_affine(random, 1 + i % 10, i % 3 == 0 ? 1e5f : 10.f);
    const Block top = build_instances({instance_of(bottom, m)});
    const InstanceRecord record = record_of(m);
    size_t leaks = 0, inside = 0;
    for (int k = 0; k < 200; ++k) {
      const Point to = transformed(m, mesh.vertices[random.below(uint32_t(mesh.vertices.size()))]);
      const Ray ray = ray_between(transformed(m, {0.1f, 0, -0.1f}), to);
      const Ray object = object_ray(record, ray);
      const float distance = std::hypot(object.origin[0], object.origin[1], object.origin[2]);
      if (distance > 0.5f) continue;  // rounding in world space has moved it out
      ++inside;
      Recorder recorder;
      trace({}, recorder.request(top, ray));
      leaks += recorder.candidates.size() != 1;
    }
    CAPTURE(i);
    CHECK(leaks == 0);
    CHECK((inside > 0 || i % 3 == 0));
  }
}

TEST_CASE("inactive instances never hit and keep their indices (PR-03, PR-05, PR-06, TL-08)") {
  const Mesh mesh = icosphere(0);
  const Block bottom = build_mesh(mesh);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<InstanceDesc> descs(7, instance_of(bottom));
  descs[0].bottom_level_address = 0;
  descs[1].transform[1][2] = nan;
  descs[2].transform[0][3] = Box::infinity;
  std::memset(descs[3].transform, 0, sizeof(descs[3].transform));
  descs[4].transform[2][2] = 0;  // flattened
  descs[5].instance_mask = 0;
  descs[6].instance_id = 0xFFFFFF;
  descs[6].instance_contribution_to_hit_group_index = 0xABCDEF;
  const Block top = build_instances(descs);
  const StructureInfo info = structure_info(top.data());
  CHECK(info.top_level);
  CHECK(info.primitives == 7);
  CHECK(info.active_primitives == 1);
  const Hit hit = trace({}, request_for(top, {{0, 0, 0}, 0, {1, 2, 3}, Box::infinity}));
  CHECK(hit.instance_index == 6);

  descs.pop_back();
  const Block nothing = build_instances(descs);
  CHECK(!trace({}, request_for(nothing, {{0, 0, 0}, 0, {1, 2, 3}, Box::infinity})));
  CHECK(!trace({}, request_for(build_instances({}), {{0, 0, 0}, 0, {1, 2, 3}, Box::infinity})));
}

TEST_CASE("an empty bottom level is a legal instance (PR-14, BI-19)") {
  const Block empty = build_geometries(std::vector<TriangleGeometry>{});
  const Mesh mesh = icosphere(0);
  const Block bottom = build_mesh(mesh);
  for (const uint32_t flags : {build_flag::none, build_flag::allow_update}) {
    const Block top = build_instances({instance_of(empty), instance_of(bottom), instance_of(empty)}, flags);
    CHECK(trace({}, request_for(top, {{0, 0, 0}, 0, {1, 2, 3}, Box::infinity})).instance_index == 1);
    CHECK(structure_info(top.data()).active_primitives == (flags ? 3 : 1));
  }
}

TEST_CASE("the candidate points to its instance's record (TL-04, TL-14)") {
  const Mesh mesh = icosphere(0);
  const Block bottom = build_mesh(mesh, geometry_flag::none);
  InstanceDesc desc = instance_of(bottom, {2, 0, 0, 5, 0, 2, 0, 6, 0, 0, 2, 7});
  desc.instance_id = 0x123456;
  desc.instance_mask = 0x81;
  desc.instance_contribution_to_hit_group_index = 0x654321;
  desc.flags = instance_flag::triangle_cull_disable;
  const Block top = build_instances({instance_of(bottom), desc});
  Recorder recorder;
  trace({}, recorder.request(top, {{5, 6, 7}, 0, {1, 2, 3}, Box::infinity}));
  REQUIRE(recorder.candidates.size() == 1);
  REQUIRE(recorder.candidates[0].instance);
  const auto& record = *reinterpret_cast<const InstanceRecord*>(recorder.candidates[0].instance);
  CHECK(record.instance_index == 1);
  CHECK(record.id_and_mask == 0x81123456u);
  CHECK(record.contribution_and_flags == 0x01654321u);
  CHECK(record.bottom_level_address == bottom.address());
  CHECK(record.object_to_world[2][3] == 7);
  CHECK(record.world_to_object[0][0] == 0.5);
  CHECK(record.world_to_object[1][3] == -3);
}

TEST_CASE("an address that is no bottom level is refused by name") {
  const Mesh mesh = icosphere(0);
  const Block bottom = build_mesh(mesh);
  const Block top = build_instances({instance_of(bottom)});
  CHECK_THROWS_WITH(build_instances({instance_of(bottom), instance_of(top)}), Catch::Contains("instances[1]"));
  Block noise(4096);
  CHECK_THROWS_WITH(build_instances({instance_of(noise)}), Catch::Contains("instances[0]"));
}
