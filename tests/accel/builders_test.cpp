// What every builder must keep, tried with each of them: the same hits, the same bytes, bounds on depth and size.

#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <cfenv>
#include <chrono>
#include <functional>

#include "check_structure.h"
#include "random.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

Block build_by(const BuildSettings& settings, const Mesh& mesh, uint32_t flags = geometry_flag::opaque) {
  const TriangleGeometry geometry = mesh.geometry(flags);
  Block block(bottom_level_sizes({&geometry, 1}, settings).result_bytes);
  block.used = build_bottom_level({&geometry, 1}, settings, block.span());
  return block;
}

Block build_top_by(const BuildSettings& settings, const std::vector<InstanceDesc>& descs) {
  Block block(top_level_sizes(descs.size(), settings).result_bytes);
  block.used = build_top_level(descs, {}, settings, block.span());
  return block;
}

bool same_bytes(const Block& a, const Block& b) {
  return a.used == b.used && std::memcmp(a.data(), b.data(), a.used) == 0;
}

Point any_point(Random& random) { return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; }

Point near(const Point& p, float distance, Random& random) {
  Point q = p;
  for (float& x : q) x += distance * random.uniform(-1, 1);
  return q;
}

/// Triangles of all sizes, some sharing an edge, some twice there.
Mesh mixed(size_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  while (mesh.triangles.size() < count) {
    const float size = random.scaled(-12, 0);
    const Point a = any_point(random), b = near(a, size, random), c = near(a, size, random);
    mesh.add_triangle(a, b, c);
    if (random.chance(3)) mesh.add_triangle(b, a, near(a, size, random));
    if (random.chance(9)) mesh.triangles.push_back(mesh.triangles.back());
  }
  mesh.triangles.resize(count);
  return mesh;
}

Mesh equal_centres(size_t count) {
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const float r = 1 + static_cast<float>(i) / static_cast<float>(count);
    mesh.add_triangle({-r, -r, 1}, {r, -r, 1}, {0, r, 1});
  }
  return mesh;
}

/// Shells whose sizes halve.
Mesh nested(size_t count) {
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const float z = std::ldexp(1.0f + 0.0001f * static_cast<float>(i / 140), -static_cast<int>(i % 140));
    mesh.add_triangle({-z, -z, z}, {z, -z, z}, {0, z, z});
  }
  return mesh;
}

Mesh giant_and_tiny(size_t count) {
  Random random(82);
  Mesh mesh;
  mesh.add_triangle({-3e37f, -3e37f, 0}, {3e37f, -3e37f, 0}, {0, 3e37f, 1});
  while (mesh.triangles.size() < count) {
    const Point a = any_point(random);
    mesh.add_triangle(a, near(a, 1e-3f, random), near(a, 1e-3f, random));
  }
  return mesh;
}

Mesh any_coordinates(size_t count) {
  Random random(83);
  Mesh mesh;
  const auto any = [&] { return Point{random.any_finite(), random.any_finite(), random.any_finite()}; };
  while (mesh.triangles.size() < count) mesh.add_triangle(any(), any(), any());
  return mesh;
}

/// A dense cluster that 30-bit codes would put into one cell, and a few points far off.
Mesh cluster(size_t count) {
  Random random(84);
  Mesh mesh;
  mesh.add_triangle({5000, 5000, 5000}, {5001, 5000, 5000}, {5000, 5001, 5000});
  while (mesh.triangles.size() < count) {
    const Point a = any_point(random);
    mesh.add_triangle(a, near(a, 1e-3f, random), near(a, 1e-3f, random));
  }
  return mesh;
}

Mesh with_gaps(size_t count) {
  Mesh mesh = mixed(count, 85);
  for (size_t i = 0; i < mesh.vertices.size(); i += 7)
    mesh.vertices[i][i % 3] = std::numeric_limits<float>::quiet_NaN();
  return mesh;
}

std::vector<Ray> rays_at(const Mesh& mesh, size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const auto& triangle = mesh.triangles[random.below(static_cast<uint32_t>(mesh.triangles.size()))];
    const Point &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
    const float u = random.chance(3) ? 0 : random.uniform(0, 1), v = (1 - u) * random.uniform(0, 1);
    Point target;
    for (int k = 0; k < 3; ++k) target[k] = (1 - u - v) * a[k] + u * b[k] + v * c[k];
    rays.push_back(ray_between(near(target, 2, random), target));
  }
  return rays;
}

std::vector<Hit> hits_of(const Block& block, const std::vector<Ray>& rays) {
  std::vector<Hit> hits;
  for (const Ray& ray : rays) hits.push_back(trace({}, request_for(block, ray)));
  return hits;
}

size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += !same_bits(a[i], b[i]);
  return count;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<InstanceDesc> scattered(const Block& bottom, size_t count) {
  Random random(86);
  std::vector<InstanceDesc> descs(count, instance_of(bottom));
  for (InstanceDesc& desc : descs)
    for (auto& row : desc.transform) row[3] = random.uniform(-30, 30);
  return descs;
}

}  // namespace

TEST_CASE("the closest hit is the same from every builder's tree (G3b)") {
  const Mesh meshes[] = {mixed(5000, 81), bumpy_sphere(4), cluster(3000), nested(280), with_gaps(3000)};
  for (const Mesh& mesh : meshes) {
    const std::vector<Ray> rays = rays_at(mesh, 1000, 87);
    const std::vector<Hit> expected = hits_of(build_by({0, Builder::binned_sah}, mesh), rays);
    CHECK(std::count_if(expected.begin(), expected.end(), [](const Hit& hit) { return bool(hit); }) > 250);
    for (const Builder builder : all_builders())
      for (const uint32_t flags : {build_flag::none, build_flag::allow_update, build_flag::minimize_memory}) {
        CAPTURE(builder_name(builder), flags);
        CHECK(differences(hits_of(build_by({flags, builder}, mesh), rays), expected) == 0);
      }
  }
}

TEST_CASE("the closest instance is the same from every builder's top level (G3b)") {
  const Block bottom = build_mesh(icosphere(2));
  const std::vector<InstanceDesc> descs = scattered(bottom, 3000);
  Random random(88);
  std::vector<Ray> rays;
  for (int i = 0; i < 1000; ++i) {
    const auto any = [&] { return 30 * random.uniform(-1, 1); };
    rays.push_back(ray_between({any(), any(), any()}, {any(), any(), any()}));
  }
  const std::vector<Hit> expected = hits_of(build_top_by({0, Builder::binned_sah}, descs), rays);
  for (const Builder builder : all_builders()) {
    CAPTURE(builder_name(builder));
    const Block top = build_top_by({0, builder}, descs);
    CHECK(differences(hits_of(top, rays), expected) == 0);
    CHECK(structure_info(top.data()).builder == chosen_builder(StructureKind::instances, {0, builder}));
  }
}

TEST_CASE("every builder writes the same bytes for any number of threads (DET-07)") {
  const Mesh mesh = mixed(100000, 89);
  const Block bottom = build_mesh(icosphere(1));
  const std::vector<InstanceDesc> descs = scattered(bottom, 20000);
  for (const Builder builder : all_builders()) {
    CAPTURE(builder_name(builder));
    const auto build_with = [&](unsigned threads) {
      const ThreadLimit limit(threads);
      const auto build = [&] { return std::pair{build_by({0, builder}, mesh), build_top_by({0, builder}, descs)}; };
      auto result = build();
      for (int again = 0; threads > 1 && threads_seen() == 1 && again < 50; ++again) result = build();  // busy machine
      if (threads > 1) CHECK(threads_seen() > 1);
      return result;
    };
    const auto one = build_with(1);
    for (const unsigned threads : {2u, 7u}) {
      const auto many = build_with(threads);
      CHECK(same_bytes(one.first, many.first));
      CHECK(same_bytes(one.second, many.second));
    }
  }
}

TEST_CASE("every builder writes the same bytes in any floating-point environment of the caller") {
  const Mesh meshes[] = {mixed(20000, 90), nested(3000), any_coordinates(2000)};
  for (const Mesh& mesh : meshes)
    for (const Builder builder : all_builders()) {
      CAPTURE(builder_name(builder));
      const Block expected = build_by({0, builder}, mesh);
      for (const int rounding : {FE_UPWARD, FE_TOWARDZERO}) {
        REQUIRE(std::fesetround(rounding) == 0);
#if defined(__SSE__)
        _mm_setcsr(_mm_getcsr() | 0x8040);  // flush to zero, denormals are zero
#endif
        const Block block = build_by({0, builder}, mesh);
#if defined(__SSE__)
        _mm_setcsr(_mm_getcsr() & ~0x8040u);
#endif
        std::fesetround(FE_TONEAREST);
        CHECK(same_bytes(block, expected));
      }
    }
}

TEST_CASE("every builder keeps depth, size and time on inputs made to hurt (B1, B2, BI-26)") {
  constexpr size_t count = 60000;
  const std::function<Mesh(size_t)> makers[] = {equal_centres,   nested,  giant_and_tiny,
                                                any_coordinates, cluster, with_gaps};
  for (const auto& make : makers) {
    const Mesh mesh = make(count);
    for (const Builder builder : all_builders())
      for (const uint32_t flags : {build_flag::none, build_flag::minimize_memory}) {
        CAPTURE(builder_name(builder), flags, &make - makers);
        Block block(structure_alignment);
        CHECK(seconds_of([&] { block = build_by({flags, builder}, mesh); }) < 10);
        StructureChecker checker(block);  // depth, enclosure, every primitive once, within the size asked for
      }
  }
}

TEST_CASE("every builder makes small structures of any count") {
  for (const Builder builder : all_builders())
    for (const size_t count : {1u, 2u, 3u, 7u, 8u, 9u, 15u, 16u, 17u, 25u, 64u, 65u, 130u}) {
      CAPTURE(builder_name(builder), count);
      const Block block = build_by({build_flag::minimize_memory, builder}, mixed(count, 91));
      StructureChecker checker(block);
      CHECK(checker.facts.names.size() == count);
    }
}

TEST_CASE("every builder makes procedural structures") {
  Random random(92);
  std::vector<float> bounds;
  for (int i = 0; i < 5000; ++i) {
    const Point a = any_point(random), b = near(a, 0.1f, random);
    bounds.insert(bounds.end(), {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])});
    bounds.insert(bounds.end(), {std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])});
  }
  const AabbGeometry boxes{reinterpret_cast<const std::byte*>(bounds.data()), 24, bounds.size() / 6, 0};
  for (const Builder builder : all_builders()) {
    CAPTURE(builder_name(builder));
    Block block(bottom_level_sizes({&boxes, 1}, {0, builder}).result_bytes);
    block.used = build_bottom_level({&boxes, 1}, {0, builder}, block.span());
    StructureChecker checker(block);
    CHECK(checker.facts.names.size() == 5000);
  }
}
