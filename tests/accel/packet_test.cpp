// Packets against the single-ray kernel, bit for bit; compiled per target as accel/simd/kernel_highway.cpp is, so that
// the number of rays that went in packets can be seen.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/tests/accel/packet_test.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <hwy/highway.h>

#include <rayloom/accel/batch-inl.h>

#ifndef RAYLOOM_TESTS_ACCEL_PACKET_TEST
#define RAYLOOM_TESTS_ACCEL_PACKET_TEST

namespace rayloom::accel {

/// Traces rays and returns how many of them went in packets.
using PacketFunction = size_t (*)(const TraceRequest& shared, std::span<const Ray>, std::span<Hit>);

}  // namespace rayloom::accel

#endif

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

size_t run_packets(const TraceRequest& shared, std::span<const Ray> rays, std::span<Hit> hits) {
  return trace_in_packets({}, {&shared, rays.data(), sizeof(Ray), rays.size()}, hits.data());
}

PacketFunction packet_function() { return run_packets; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "random.h"
#include "structures.h"
#include "targets.h"

#include <rayloom/base/float_environment.h>

#include <catch2/catch.hpp>

namespace rayloom::accel {
namespace {

using namespace test;

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Outcomes {
  size_t in_packets = 0, hits = 0;
};

/// Traces the rays as a batch and one by one, on each target; the results of the last.
Outcomes compare(const Block& block, const std::vector<Ray>& rays, uint32_t flags = ray_flag::none) {
  const Isa before = current_isa();
  Outcomes outcomes;
  for (const auto& target : supported_targets(N_AVX2::packet_function(), N_AVX3::packet_function())) {
    set_isa(target.isa);
    std::vector<Hit> hits(rays.size());
    TraceRequest shared = request_for(block, rays[0], flags);
    {
      const FloatEnvironment environment;
      outcomes.in_packets = target.functions(shared, rays, hits);
    }
    size_t different = 0;
    outcomes.hits = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      shared.ray = rays[i];
      different += !same_bits(hits[i], trace({}, shared));
      outcomes.hits += hits[i].type == HitType::triangle;
    }
    CHECK(different == 0);
  }
  set_isa(before);
  return outcomes;
}

/// Size x size rays in blocks of 4 x 4, from `eye` through a window of half-width `half` around `target`.
std::vector<Ray> camera(const Point& eye, const Point& target, float half, int size, float length = 1) {
  std::vector<Ray> rays;
  const float step = 2 * half / static_cast<float>(size);
  for (int block = 0; block < size * size / 16; ++block)
    for (int i = 0; i < 16; ++i) {
      const int x = block % (size / 4) * 4 + i % 4, y = block / (size / 4) * 4 + i / 4;
      const float a = (static_cast<float>(x) + 0.5f) * step - half, b = (static_cast<float>(y) + 0.5f) * step - half;
      const Point through = {target[0] + a, target[1] + b, target[2] + 0.3f * a - 0.2f * b};
      Ray ray = ray_between(eye, through);
      for (float& component : ray.direction) component *= length;
      rays.push_back(ray);
    }
  return rays;
}

std::vector<Ray> towards(const Point& eye, const std::vector<Point>& targets, int copies, Random& random) {
  std::vector<Ray> rays;
  for (const Point& target : targets)
    for (int i = 0; i < copies; ++i) {
      Ray ray = ray_between(eye, target);
      for (float& component : ray.direction)
        component = std::bit_cast<float>(std::bit_cast<uint32_t>(component) + random.below(3));
      rays.push_back(ray);
    }
  return rays;
}

}  // namespace

TEST_CASE("camera rays go in packets and find what single rays find") {
  for (const Mesh& mesh : {bumpy_sphere(4), torus(60, 30, 0.3f), cube(4)}) {
    const Block block = build_mesh(mesh);
    const auto rays = camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.2f, 64);
    const Outcomes outcomes = compare(block, rays);
    CHECK(outcomes.in_packets > rays.size() * 9 / 10);
    CHECK(outcomes.hits > rays.size() / 10);
  }
}

TEST_CASE("packets from inside a closed mesh hit every time, in all directions") {
  const Block block = build_mesh(bumpy_sphere(4));
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const Point target = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto rays = camera({0.1f, -0.1f, 0.05f}, target, 0.05f, 16);
    CHECK(compare(block, rays).hits == rays.size());
  }
}

TEST_CASE("packets at huge and tiny scales, and of long and short directions") {
  for (const float scale : {1e-15f, 1e-9f, 1e-3f, 1e4f, 1e10f})
    for (const float length : {1e-12f, 1.0f, 1e12f}) {
      const Block block = build_mesh(moved(bumpy_sphere(3), scale, 0));
      const auto rays = camera({0.3f * scale, 0.2f * scale, 4 * scale}, {0, 0, 0}, 1.2f * scale, 32, length);
      const Outcomes outcomes = compare(block, rays);
      CHECK(outcomes.hits > rays.size() / 10);
      if (length * scale < 1e15f && length * scale > 1e-15f) CHECK(outcomes.in_packets > rays.size() / 2);
    }
  for (const float scale : {1e-30f, 1e30f}) {  // no packets, the same hits
    const Block block = build_mesh(moved(bumpy_sphere(3), scale, 0));
    const auto rays = camera({0.3f * scale, 0.2f * scale, 4 * scale}, {0, 0, 0}, 1.2f * scale, 32);
    CHECK(compare(block, rays).in_packets == 0);
  }
}

TEST_CASE("packets far from the origin of coordinates") {
  for (const float offset : {1e2f, 1e4f, 1e6f}) {
    const Block block = build_mesh(moved(bumpy_sphere(3), 1, offset));
    const auto rays = camera({offset, offset, offset + 4}, {offset, offset, offset}, 1, 32);
    CHECK(compare(block, rays).hits > 0);
  }
}

TEST_CASE("packets aimed at vertices and the middles of edges") {
  const Mesh mesh = bumpy_sphere(3);
  const Block block = build_mesh(mesh);
  Random random(2);
  std::vector<Point> aims;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Point &p = mesh.vertices[a], &q = mesh.vertices[b];
    aims.push_back(p);
    aims.push_back({0.5f * (p[0] + q[0]), 0.5f * (p[1] + q[1]), 0.5f * (p[2] + q[2])});
  }
  const auto rays = towards({0, 0, 0}, aims, 16, random);
  const Outcomes outcomes = compare(block, rays);
  CHECK(outcomes.hits == rays.size());
  CHECK(outcomes.in_packets > rays.size() / 2);
}

TEST_CASE("axis-parallel packets on grids, where every hit is a tie") {
  Mesh mesh = grid(16, 2);
  const Mesh again = grid(16, 2);  // the same triangles once more: equal t, decided by the names
  const Block block = build_geometries(std::vector{again.geometry(), mesh.geometry()});
  for (const float minus : {0.0f, -0.0f})
    for (int x = 0; x < 16; ++x) {
      std::vector<Ray> rays;
      for (int i = 0; i < 64; ++i) {
        const float side = static_cast<float>(i % 8) * 0.0625f, up = static_cast<float>(i / 8) * 0.0625f;
        rays.push_back({{static_cast<float>(x), 8, 0}, 0, {i < 16 ? minus : side, i < 16 ? minus : up, 1}, infinity});
      }
      const Outcomes outcomes = compare(block, rays);
      CHECK(outcomes.in_packets > 0);
      CHECK(outcomes.hits > 0);
    }
}

TEST_CASE("packets through needles") {
  Random random(3);
  const Block block = build_mesh(needles(2000, 1e-5f, 1e-4f, random));
  const auto rays = camera({0.1f, 0.2f, 3}, {0, 0, 0}, 1, 128);
  const Outcomes outcomes = compare(block, rays);
  CHECK(outcomes.in_packets > rays.size() * 9 / 10);
  CHECK(outcomes.hits > 0);
}

TEST_CASE("packets with limits of t in and around the mesh") {
  const Mesh mesh = bumpy_sphere(3);
  const Block block = build_mesh(mesh);
  auto rays = camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.2f, 64);
  const TraceRequest shared = request_for(block, rays[0]);
  Random random(4);
  for (Ray& ray : rays) {
    TraceRequest request = shared;
    request.ray = ray;
    const Hit hit = trace({}, request);
    if (!hit) continue;
    switch (random.below(5)) {
      case 0:
        ray.t_max = hit.t;
        break;  // exclusive
      case 1:
        ray.t_max = std::nextafter(hit.t, infinity);
        break;
      case 2:
        ray.t_min = hit.t;
        break;  // exclusive: the far side
      case 3:
        ray.t_min = std::nextafter(hit.t, 0.0f);
        break;
      default:
        ray.t_min = ray.t_max = hit.t;
        break;
    }
  }
  CHECK(compare(block, rays).in_packets > rays.size() / 2);
}

TEST_CASE("packets obey culling and opacity flags") {
  const Mesh near = bumpy_sphere(3), far = torus(40, 20, 0.3f);
  const Block block = build_geometries(std::vector{near.geometry(), far.geometry(geometry_flag::none)});
  const auto rays = camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.5f, 64);
  for (const uint32_t flags :
       {ray_flag::cull_back_facing_triangles, ray_flag::cull_front_facing_triangles, ray_flag::cull_opaque,
        ray_flag::cull_non_opaque, ray_flag::force_opaque | ray_flag::cull_non_opaque}) {
    const Outcomes outcomes = compare(block, rays, flags);
    CHECK(outcomes.in_packets > rays.size() / 2);
    CHECK(outcomes.hits > 0);
  }
}

TEST_CASE("groups that go together among rays that do not") {
  const Block block = build_mesh(bumpy_sphere(3));
  Random random(5);
  auto rays = camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.2f, 64);
  for (size_t i = 0; i < rays.size(); ++i) {
    const size_t run = i / 96 % 4;
    if (run == 1)
      for (float& x : rays[i].direction) x = random.uniform(-1, 1);  // no packet
    if (run == 2 && random.chance(3)) rays[i].direction[0] *= -1;    // parts of one
    if (run == 3 && random.chance(8)) rays[i].origin[random.below(3)] = random.chance(2) ? infinity : NAN;  // misses
  }
  rays.resize(rays.size() - 5);
  const Outcomes outcomes = compare(block, rays);
  CHECK(outcomes.in_packets > rays.size() / 4);
  CHECK(outcomes.in_packets < rays.size() * 19 / 20);
}

TEST_CASE("the last packet of a batch may be a part of one") {
  const Block block = build_mesh(bumpy_sphere(3));
  const auto rays = camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.0f, 64);
  for (size_t count = 16; count < 80; ++count) {
    const Outcomes outcomes = compare(block, std::vector<Ray>(rays.begin() + 1000, rays.begin() + 1000 + count));
    CHECK(outcomes.in_packets + 8 > count);
  }
}

TEST_CASE("wide packets take those that lie near their first ray, and the next one takes the others") {
  const Block block = build_mesh(bumpy_sphere(4));
  const auto rays = camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.1f, 16);
  const Outcomes outcomes = compare(block, rays);
  CHECK(outcomes.in_packets > rays.size() / 2);
  CHECK(outcomes.hits > rays.size() / 10);
}

/// Turned about an axis that no coordinate axis is near, scaled and moved.
Transform3x4 placed(float scale, const Point& at, float turn) {
  const float c = std::cos(turn), s = std::sin(turn);
  return {scale * c, -scale * s * 0.6f, scale * s * 0.8f, at[0], scale * s, scale * c * 0.6f, -scale * c * 0.8f, at[1],
          0,         scale * 0.8f,      scale * 0.6f,     at[2]};
}

TEST_CASE("packets go through instances and find what single rays find") {
  const Block sphere = build_mesh(bumpy_sphere(3)), ring = build_mesh(torus(40, 20, 0.3f));
  Random random(6);
  std::vector<InstanceDesc> instances = {instance_of(sphere), instance_of(ring)};
  for (int i = 0; i < 24; ++i) {
    const Point at = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 1)};
    instances.push_back(
        instance_of(random.chance(2) ? sphere : ring, placed(random.uniform(0.1f, 0.6f), at, random.uniform(0, 6))));
  }
  instances.push_back(instance_of(sphere, {-0.5f, 0, 0, 1, 0, 0.5f, 0, 1, 0, 0, 0.5f, 1}));  // mirrored
  const Block top = build_instances(instances);
  const auto rays = camera({0.3f, 0.2f, 6}, {0, 0, 0}, 1.5f, 96);
  for (const uint32_t flags : {ray_flag::none, ray_flag::cull_back_facing_triangles,
                               ray_flag::cull_front_facing_triangles, ray_flag::cull_non_opaque}) {
    const Outcomes outcomes = compare(top, rays, flags);
    CHECK(outcomes.in_packets > rays.size() * 9 / 10);
    CHECK(outcomes.hits > rays.size() / 10);
  }
}

TEST_CASE("packets obey the masks and flags of instances, and the smallest name wins between equal ones") {
  const Block sphere = build_mesh(bumpy_sphere(3));
  std::vector<InstanceDesc> instances;
  for (uint32_t i = 0; i < 6; ++i) {  // three pairs in one place
    instances.push_back(instance_of(sphere, placed(0.4f, {static_cast<float>(i / 2) - 1.0f, 0, 0}, 0.7f)));
    instances.back().instance_mask = i == 3 ? 0 : 0xFF;
    if (i >= 4) instances.back().flags = instance_flag::triangle_front_counterclockwise;
  }
  instances[2].flags = instance_flag::triangle_cull_disable;
  const Block top = build_instances(instances);
  const auto rays = camera({0.1f, 0.3f, 5}, {0, 0, 0}, 1.4f, 96);
  for (const uint32_t flags : {ray_flag::none, ray_flag::cull_back_facing_triangles,
                               ray_flag::cull_front_facing_triangles | ray_flag::force_opaque}) {
    const Outcomes outcomes = compare(top, rays, flags);
    CHECK(outcomes.in_packets > rays.size() / 2);
    CHECK(outcomes.hits > 0);
  }
}

TEST_CASE("packets through instances at huge and tiny scales and far from the origin") {
  const Block sphere = build_mesh(bumpy_sphere(3));
  for (const float scale : {1e-6f, 1e-2f, 1e3f, 1e7f})
    for (const float offset : {0.0f, 3.0f, 1e3f}) {
      const Point at = {offset * scale, -offset * scale, offset * scale};
      const Block top = build_instances({instance_of(sphere, placed(scale, at, 1.1f))});
      const Point eye = {at[0] + 0.3f * scale, at[1] + 0.2f * scale, at[2] + 4 * scale};
      CHECK(compare(top, camera(eye, at, 1.2f * scale, 32)).hits > 0);
    }
}

TEST_CASE("packets meet instances of nothing, of boxes, and ill-conditioned ones") {
  const Block sphere = build_mesh(bumpy_sphere(3)), empty = build_mesh(Mesh{});
  const Transform3x4 flat = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1e-5f, 0};
  const Transform3x4 sheared = {1, 1e4f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const Block top = build_instances({instance_of(empty), instance_of(sphere, flat), instance_of(sphere, sheared)});
  CHECK(compare(top, camera({0.3f, 0.2f, 4}, {0, 0, 0}, 1.2f, 48)).hits > 0);
}

TEST_CASE("packets that miss and a structure of one triangle") {
  Mesh mesh;
  mesh.add_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  const Block block = build_mesh(mesh);
  const auto away = camera({0, 0, 4}, {0, 0, 8}, 1, 16);
  CHECK(compare(block, away).hits == 0);
  CHECK(compare(block, camera({0, 0, 4}, {0, 0, 0}, 1.5f, 32)).hits > 100);
}

}  // namespace rayloom::accel

#endif  // HWY_ONCE
