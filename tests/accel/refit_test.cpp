// Updates: hits equal those of a fresh build with the same data, whatever came before (UP-08).

#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include "check_structure.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr uint32_t updatable = build_flag::allow_update;

template <class Geometry>
uint64_t refit(const std::vector<Geometry>& geometries, const Block& source, const Block& result,
               uint32_t flags = updatable) {
  return refit_bottom_level(std::span<const Geometry>(geometries), flags, source.data(), result.span());
}

uint64_t refit(const Mesh& mesh, const Block& block, uint32_t flags = updatable) {
  return refit(std::vector{mesh.geometry()}, block, block, flags);
}

/// Every vertex somewhere else.
Mesh shaken(Mesh mesh, float reach, uint64_t seed) {
  Random random(seed);
  for (Point& p : mesh.vertices)
    for (float& x : p) x += random.uniform(-reach, reach);
  return mesh;
}

std::vector<Ray> rays_at(const Mesh& mesh, size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const Point from{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    rays.push_back(ray_between(from, mesh.vertices[random.below(uint32_t(mesh.vertices.size()))]));
  }
  return rays;
}

size_t different_hits(const Block& a, const Block& b, const std::vector<Ray>& rays) {
  size_t different = 0;
  for (const Ray& ray : rays) different += !same_bits(trace({}, request_for(a, ray)), trace({}, request_for(b, ray)));
  return different;
}

std::vector<std::byte> bytes_of(const Block& block) { return {block.data(), block.data() + block.used}; }

}  // namespace

TEST_CASE("after an update hits equal those of a fresh build (UP-02, UP-07, UP-08)") {
  const Mesh mesh = bumpy_sphere(4);
  const Block block = build_mesh(mesh, geometry_flag::opaque, updatable);
  for (const float reach : {0.01f, 0.1f, 1.0f, 0.0f}) {
    for (uint64_t round = 0; round < 5; ++round) {
      const Mesh moved = shaken(mesh, reach, 70 + round);
      CHECK(refit(moved, block) == block.used);
      const Block fresh = build_mesh(moved);
      const auto rays = rays_at(moved, 300, 80 + round);
      for_each_isa([&](Isa) { CHECK(different_hits(block, fresh, rays) == 0); });
      StructureChecker checker(block);
      CHECK(std::equal(block.header().bounds_min, block.header().bounds_min + 3, fresh.header().bounds_min));
    }
  }
}

TEST_CASE("an update without changes gives back every byte, quality as well") {
  const Mesh mesh = bumpy_sphere(4);
  const Block block = build_mesh(mesh, geometry_flag::opaque, updatable);
  const auto before = bytes_of(block);
  const double cost = block.header().sah_cost;
  refit(mesh, block);
  const auto after = bytes_of(block);
  CHECK(std::equal(before.begin() + sizeof(StructureHeader), before.end(), after.begin() + sizeof(StructureHeader)));
  CHECK(block.header().sah_cost == Approx(cost).epsilon(1e-9));
}

TEST_CASE("an update elsewhere leaves its source alone and equals one in place (UP-01, UP-09)") {
  const Mesh mesh = icosphere(3), moved = shaken(mesh, 0.2f, 71);
  Block source = build_mesh(mesh, geometry_flag::opaque, updatable);
  const auto before = bytes_of(source);
  Block result((source.used + 255) / 256 * 256);
  result.used = refit(std::vector{moved.geometry()}, source, result);
  CHECK(bytes_of(source) == before);
  refit(moved, source);
  CHECK(bytes_of(source) == bytes_of(result));
}

TEST_CASE("the same bytes for any number of threads (DET-07)") {
  const Mesh mesh = bumpy_sphere(5), moved = shaken(mesh, 0.1f, 72);
  std::vector<std::byte> first;
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    const Block block = build_mesh(mesh, geometry_flag::opaque, updatable);
    refit(moved, block);
    if (first.empty()) first = bytes_of(block);
    CHECK(bytes_of(block) == first);
  }
}

TEST_CASE("triangles degenerate and wake up, are lost and come back (PR-08, PR-09, UP-15)") {
  const Mesh mesh = icosphere(2);
  Mesh flat = mesh, gone = mesh, all_gone = mesh;
  for (const uint32_t corner : mesh.triangles[7]) flat.vertices[corner] = {0, 0, 0};
  gone.vertices[5][0] = std::numeric_limits<float>::quiet_NaN();
  for (Point& p : all_gone.vertices) p[0] = std::numeric_limits<float>::quiet_NaN();
  const Block block = build_mesh(flat, geometry_flag::opaque, updatable);
  const auto rays = rays_at(mesh, 300, 73);
  for (const Mesh* step : std::initializer_list<const Mesh*>{&mesh, &gone, &mesh, &flat, &all_gone, &mesh}) {
    refit(*step, block);
    CHECK(different_hits(block, build_mesh(*step), rays) == 0);
  }
}

TEST_CASE("procedural boxes move (UP-04)") {
  Random random(74);
  const auto boxes = [&] {
    std::vector<std::array<float, 6>> list(500);
    for (auto& box : list)
      for (int k = 0; k < 3; ++k) {
        box[k] = random.uniform(-1, 1);
        box[3 + k] = box[k] + random.uniform(0, 0.2f);
      }
    return list;
  };
  const auto geometry_of = [](const std::vector<std::array<float, 6>>& list) {
    return std::vector{AabbGeometry{reinterpret_cast<const std::byte*>(list.data()), 24, list.size()}};
  };
  const auto first = boxes(), second = boxes();
  const Block block = build_geometries(geometry_of(first), updatable), fresh = build_geometries(geometry_of(second));
  refit(geometry_of(second), block, block);
  StructureChecker checker(block);
  for (int i = 0; i < 200; ++i) {
    const Ray ray = ray_between({random.uniform(-2, 2), random.uniform(-2, 2), -2}, {0, 0, 0});
    Recorder updated, built;
    trace({}, updated.request(block, ray));
    trace({}, built.request(fresh, ray));
    auto a = updated.trail(), b = built.trail();
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    CHECK(a == b);
  }
}

TEST_CASE("everything of an instance may change but its number (UP-05, PR-14)") {
  std::vector<Block> bottoms;
  bottoms.push_back(build_mesh(icosphere(3)));
  bottoms.push_back(build_mesh(torus(30, 16, 0.25f)));
  bottoms.push_back(build_geometries(std::vector<TriangleGeometry>{}));
  Random random(75);
  const auto place = [&] {
    std::vector<InstanceDesc> descs;
    for (uint32_t i = 0; i < 200; ++i) {
      const float s = random.chance(20) ? 1e-4f : random.uniform(0.05f, 0.4f), t = random.uniform(-0.3f, 0.3f);
      const auto at = [&] { return random.uniform(-2, 2); };
      InstanceDesc desc = instance_of(bottoms[random.below(3)], {s, t, 0, at(), 0, s, 0, at(), t, 0, s, at()});
      desc.instance_mask = random.chance(8) ? 0 : random.below(256) & 0xFF;
      desc.instance_id = (i * 3) & 0xFFFFFF;
      desc.flags = random.below(16) & 0xF;
      descs.push_back(desc);
    }
    return descs;
  };
  const Block top = build_instances(place(), updatable);
  for (int round = 0; round < 5; ++round) {
    const auto descs = place();
    CHECK(refit_top_level(descs, {}, updatable, top.data(), top.span()) == top.used);
    const Block fresh = build_instances(descs);
    CHECK(top.header().non_opaque_count == fresh.header().non_opaque_count);
    size_t different = 0, hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto any = [&] { return random.uniform(-2, 2); };
      const Ray ray = ray_between({any(), any(), any()}, {any(), any(), any()});
      const Hit hit = trace({}, request_for(top, ray));
      hits += bool(hit);
      different += !same_bits(hit, trace({}, request_for(fresh, ray)));
    }
    CHECK(different == 0);
    CHECK(hits > 200);
  }
}

TEST_CASE("an ill-conditioned instance is visited always, also after an update") {
  const Block bottom = build_mesh(icosphere(2));
  const Transform3x4 thin{1e-4f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1e3f, 0};
  const Block top = build_instances({instance_of(bottom)}, updatable);
  const std::vector<InstanceDesc> update{instance_of(bottom, thin)};
  refit_top_level(update, {}, updatable, top.data(), top.span());
  const Block fresh = build_instances(update, updatable);
  CHECK(
      std::equal(top.data() + sizeof(StructureHeader), top.data() + top.used, fresh.data() + sizeof(StructureHeader)));
  CHECK(top.header().pad_scale == fresh.header().pad_scale);
}

TEST_CASE("updates that the rules forbid are refused (UP-01, UP-02, BF-01, BF-02, BF-06)") {
  const Mesh mesh = icosphere(2), other = icosphere(1);
  const Block fixed = build_mesh(mesh), block = build_mesh(mesh, geometry_flag::opaque, updatable);
  const auto before = bytes_of(block);
  CHECK_THROWS_AS(refit(mesh, fixed), InputError);
  CHECK_THROWS_AS(refit(other, block), InputError);
  CHECK_THROWS_AS(refit(std::vector{mesh.geometry(), Mesh{}.geometry()}, block, block), InputError);
  CHECK_THROWS_AS(refit(mesh, block, updatable | build_flag::prefer_fast_trace), InputError);
  CHECK_THROWS_AS(refit(mesh, block, updatable | build_flag::allow_compaction), InputError);
  CHECK_THROWS_AS(refit_top_level({}, {}, updatable, block.data(), block.span()), InputError);
  CHECK_THROWS_AS(refit(std::vector{AabbGeometry{}}, block, block), InputError);
  const auto into = [&](std::span<std::byte> result) {
    const TriangleGeometry geometry = mesh.geometry();
    refit_bottom_level({&geometry, 1}, updatable, block.data(), result);
  };
  CHECK_THROWS_AS(into(block.span().subspan(structure_alignment)), InputError);
  CHECK_THROWS_AS(into(block.span().first(structure_alignment)), InputError);
  CHECK(bytes_of(block) == before);
  CHECK_THROWS_AS(refit(std::vector{mesh.geometry(geometry_flag::none)}, block, block), InputError);
  Mesh bad = mesh;
  bad.triangles[3][1] = 1000000;
  CHECK_THROWS_AS(refit(bad, block), InputError);
}

TEST_CASE("geometries that swapped counts are refused (UP-02)") {
  const Mesh large = icosphere(2), small = icosphere(1);
  const Block block = build_geometries(std::vector{large.geometry(), small.geometry()}, updatable);
  CHECK_THROWS_AS(refit(std::vector{small.geometry(), large.geometry()}, block, block), InputError);
}

TEST_CASE("without ALLOW_UPDATE an update is the last one (BF-01)") {
  const Mesh mesh = icosphere(2);
  const Block block = build_mesh(mesh, geometry_flag::opaque, updatable | build_flag::allow_compaction);
  refit(mesh, block, updatable | build_flag::allow_compaction);
  refit(mesh, block, build_flag::none);
  CHECK_THROWS_AS(refit(mesh, block, build_flag::none), InputError);
}
