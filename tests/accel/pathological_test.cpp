// Inputs made to hurt builders and traversal (numerics 2.3): equal centres, exponential spacing, overlapping slivers,
// random bit patterns. Nothing crashes, trees stay shallow and small, hits stay right.

#include <rayloom/accel/sizes.h>
#include <rayloom/accel/walk.h>
#include <rayloom/base/error.h>

#include <catch2/catch.hpp>

#include <chrono>

#include "brute_force.h"
#include "check_structure.h"
#include "hard_meshes.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr float infinity = Box::infinity;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Mesh slivers(size_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const auto any = [&] { return random.uniform(-1, 1); };
    const Point a{any(), any(), any()}, b{any(), any(), any()};
    mesh.add_triangle(a, b, {a[0] + 1e-4f, a[1], a[2]});
  }
  return mesh;
}

void check_against_brute_force(const Mesh& mesh, const Block& block, const std::vector<Ray>& rays) {
  const auto triangles = all_triangles({mesh.geometry()});
  for_each_isa([&](Isa) {
    size_t different = 0;
    for (const Ray& ray : rays)
      different += !same_bits(trace({}, request_for(block, ray)), closest_of(all_hits(triangles, ray), ray));
    CHECK(different == 0);
  });
}

const std::vector<Ray> axis_rays{{{0, 0, -5}, 0, {0, 0, 1}, infinity}, {{0, 0, 5}, 0, {0, 0, -1}, infinity}};

float any_float(Random& random) { return std::bit_cast<float>(static_cast<uint32_t>(random.bits())); }

}  // namespace

TEST_CASE("equal and concentric triangles give balanced, full trees in near-linear time (B1)") {
  for (const Mesh& mesh : {copies(300000), concentric(300000)}) {
    Block block(256);
    CHECK(seconds_of([&] { block = build_mesh(mesh); }) < 20);
    const StructureChecker checker(block);
    CHECK(checker.facts.primitives == 300000);
    CHECK(checker.facts.depth <= 27);  // log2(n) + 8
    CHECK(static_cast<double>(block.used) / 300000 < 60);
  }
}

TEST_CASE("exponential spacing stays within the depth bound (B2)") {
  for (const bool both_sides : {false, true})
    for (const int per_level : {1, 9, 100}) {
      const Mesh mesh = exponential(140, per_level, both_sides);
      const Block block = build_mesh(mesh);
      const StructureChecker checker(block);
      CHECK(checker.facts.depth <= max_depth);
      CHECK(checker.facts.primitives == mesh.triangles.size());
      std::vector<Ray> rays = axis_rays;
      for (int i = 0; i < 20; ++i) rays.push_back(ray_between({0, 0, 0}, mesh.vertices[size_t(i) * 3]));
      check_against_brute_force(mesh, block, rays);
    }
}

TEST_CASE("overlapping slivers (B3)") {
  const Mesh mesh = slivers(3000, 41);
  const Block block = build_mesh(mesh);
  StructureChecker checker(block);
  Random random(42);
  std::vector<Ray> rays;
  for (int i = 0; i < 100; ++i) {
    const auto any = [&] { return random.uniform(-1, 1); };
    rays.push_back(ray_between({any(), any(), any()}, mesh.vertices[random.below(9000)]));
  }
  check_against_brute_force(mesh, block, rays);
}

TEST_CASE("traversal's stack never holds more than its bound") {
  struct Watch : Visitor {
    void on_pop(uint32_t, float, bool) { --now; }
    void on_node(const Node8*, uint32_t mask, const float (&)[8]) {
      now += std::popcount(mask);
      most = std::max(most, now);
    }
    int now = 1, most = 1;
  };
  const Mesh mesh = exponential(140, 100, true);
  const Block block = build_mesh(mesh, geometry_flag::none);
  Recorder recorder;  // rejects all, so that nothing is culled
  Watch watch;
  walk({}, recorder.request(block, axis_rays[0]), watch);
  CHECK(recorder.candidates.size() > 10000);
  CHECK(watch.most <= 7 * static_cast<int>(block.header().depth) + 1);
  CHECK(watch.most <= static_cast<int>(stack_entries));
}

TEST_CASE("huge and tiny finite coordinates build and trace (BI-26)") {
  Random random(43);
  for (int round = 0; round < 20; ++round) {
    Mesh mesh;
    for (int i = 0; i < 100; ++i) {
      const auto any = [&] { return random.any_finite(); };
      mesh.add_triangle({any(), any(), any()}, {any(), any(), any()}, {any(), any(), any()});
    }
    const Block block = build_mesh(mesh);
    StructureChecker checker(block);
    std::vector<Ray> rays;
    for (int i = 0; i < 40; ++i) {
      const Point from{random.any_finite(), random.any_finite(), random.any_finite()};
      Ray ray = ray_between(from, mesh.vertices[random.below(300)]);
      for (float& d : ray.direction)
        if (!std::isfinite(d)) d = random.uniform(-1, 1);
      rays.push_back(ray);
    }
    check_against_brute_force(mesh, block, rays);
  }
}

TEST_CASE("random bits as vertices, indices, boxes and transforms (B5)") {
  Random random(44);
  size_t refused = 0, built = 0;
  for (int round = 0; round < 300; ++round) {
    Mesh mesh;
    const uint32_t count = 1 + random.below(60);
    for (uint32_t i = 0; i < count; ++i) mesh.add({any_float(random), any_float(random), any_float(random)});
    const bool bad_index = random.chance(8);
    for (uint32_t i = 0; i < count; ++i) {
      const auto index = [&] { return bad_index && random.chance(32) ? uint32_t(random.bits()) : random.below(count); };
      mesh.triangles.push_back({index(), index(), index()});
    }
    Transform3x4 transform;
    for (float& x : transform) x = any_float(random);
    TriangleGeometry geometry = mesh.geometry(random.below(4));
    if (random.chance(2)) geometry.transform = transform.data();
    const uint32_t flags = random.below(32);
    try {
      const Block block = build_geometries(std::vector{geometry, geometry}, flags);
      ++built;
      StructureChecker checker(block);
      for (int i = 0; i < 20; ++i) {
        Ray ray;
        for (float& x : ray.origin) x = any_float(random);
        for (float& x : ray.direction) x = any_float(random);
        ray.t_min = random.chance(2) ? 0 : any_float(random);
        ray.t_max = random.chance(2) ? infinity : any_float(random);
        const Hit hit = trace({}, request_for(block, ray, static_cast<uint32_t>(random.bits())));
        if (hit) CHECK((hit.t > ray.t_min && hit.t < ray.t_max));
      }
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused > 0);
  CHECK(built > 200);
}

TEST_CASE("random bits as boxes, instances and rays (B5)") {
  Random random(45);
  for (int round = 0; round < 300; ++round) {
    std::vector<float> bits(6 * (1 + random.below(40)));
    for (float& x : bits) x = any_float(random);
    const AabbGeometry geometry{reinterpret_cast<const std::byte*>(bits.data()), 24, bits.size() / 6, random.below(4)};
    const Block boxes = build_geometries(std::vector{geometry}, random.below(32));
    StructureChecker check_boxes(boxes);
    std::vector<InstanceDesc> descs(1 + random.below(30), instance_of(boxes));
    for (InstanceDesc& desc : descs) {
      for (auto& row : desc.transform)
        for (float& x : row)
          if (!random.chance(3)) x = random.chance(3) ? random.scaled(-3, 3) : any_float(random);
      desc.flags = random.below(256) & 0xFF;
      desc.instance_mask = random.below(256) & 0xFF;
    }
    const Block top = build_instances(descs, random.below(32));
    StructureChecker check_instances(top);
    for (int i = 0; i < 20; ++i) {
      Ray ray{{any_float(random), any_float(random), any_float(random)}, 0, {}, infinity};
      for (float& x : ray.direction) x = random.chance(3) ? any_float(random) : random.uniform(-1, 1);
      Recorder recorder([&](const Candidate& c) {
        return Verdict{random.chance(2), random.chance(9), random.chance(2) ? c.t_current : any_float(random),
                       random.below(128)};
      });
      const Hit hit = trace({}, recorder.request(top, ray, static_cast<uint32_t>(random.bits())));
      if (hit) CHECK((hit.t >= ray.t_min && hit.t <= ray.t_max));
    }
  }
}
