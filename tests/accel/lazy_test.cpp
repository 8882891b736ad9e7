// Lazy structures against ordinary ones of the same triangles, and how much of them is built when.

#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <thread>

#include "hard_meshes.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr uint32_t lazy = build_flag::lazy;

StructureInfo info_of(const Block& block) { return structure_info(block.data()); }

/// A lazy structure whose inputs are overwritten and freed before any ray comes.
Block build_lazy_mesh(const Mesh& mesh, uint32_t geometry_flags = geometry_flag::opaque,
                      const BuildSettings& settings = lazy) {
  Mesh copy = mesh;
  Block block = build_mesh(copy, geometry_flags, settings);
  for (Point& vertex : copy.vertices) vertex.fill(1e30f);
  for (auto& triangle : copy.triangles) triangle.fill(no_index);
  REQUIRE(info_of(block).built_parts == 0);
  return block;
}

std::vector<Ray> rays_around(uint64_t seed, size_t count, float reach = 1.5f) {
  Random random(seed);
  std::vector<Ray> rays;
  const auto any = [&] { return random.uniform(-reach, reach); };
  for (size_t i = 0; i < count; ++i) {
    Ray ray = ray_between({any(), any(), any()}, {any(), any(), any()});
    if (random.chance(5)) ray.direction[random.below(3)] = 0;
    if (random.chance(3)) ray.t_min = random.uniform(0, 1);
    if (random.chance(3)) ray.t_max = ray.t_min + random.uniform(0, 2);
    if (random.chance(20)) ray.t_max = -1;
    rays.push_back(ray);
  }
  return rays;
}

/// Rays of one origin, as a camera's: packets for ordinary structures.
std::vector<Ray> rays_from_eye(uint32_t size) {
  std::vector<Ray> rays;
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x) {
      const auto at = [&](uint32_t i) { return 1.2f * (static_cast<float>(i) / static_cast<float>(size) - 0.5f); };
      rays.push_back({{0.1f, 0.2f, 4}, 0, {at(x), at(y), -1}, Box::infinity});
    }
  return rays;
}

size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += !same_bits(a[i], b[i]);
  return count;
}

std::vector<Hit> batch(const Block& block, const std::vector<Ray>& rays, uint32_t ray_flags = 0) {
  std::vector<Hit> hits(rays.size());
  TraceRequest shared;
  shared.structure = block.data();
  shared.ray_flags = ray_flags;
  trace({}, shared, rays, hits);
  return hits;
}

std::vector<Hit> alone(const Block& block, const std::vector<Ray>& rays, uint32_t ray_flags = 0) {
  std::vector<Hit> hits;
  for (const Ray& ray : rays) hits.push_back(trace({}, request_for(block, ray, ray_flags)));
  return hits;
}

std::vector<uint8_t> any_hits(const Block& block, const std::vector<Ray>& rays) {
  std::vector<uint8_t> results(rays.size());
  TraceRequest shared;
  shared.structure = block.data();
  occluded({}, shared, rays, results);
  return results;
}

/// Asks for every candidate and takes those of odd primitives.
std::vector<Hit> asked(const Block& block, const std::vector<Ray>& rays) {
  std::vector<Hit> hits;
  for (const Ray& ray : rays) {
    Recorder recorder([](const Candidate& candidate) { return Verdict{candidate.primitive_index % 2 == 1}; });
    hits.push_back(trace({}, recorder.request(block, ray)));
  }
  return hits;
}

template <class MakeLazy>
void check_all_ways(const Block& eager, const std::vector<Ray>& rays, const MakeLazy& make_lazy) {
  for_each_isa([&](Isa isa) {
    CAPTURE(isa_name(isa));
    for (const uint32_t flags : {ray_flag::none, ray_flag::cull_back_facing_triangles, ray_flag::skip_triangles}) {
      const std::vector<Hit> expected = alone(eager, rays, flags);
      CHECK(differences(batch(make_lazy(), rays, flags), expected) == 0);
      CHECK(differences(alone(make_lazy(), rays, flags), expected) == 0);
    }
    CHECK(any_hits(make_lazy(), rays) == any_hits(eager, rays));
    CHECK(differences(asked(make_lazy(), rays), asked(eager, rays)) == 0);
  });
}

InstanceDesc turned_instance(const Block& bottom, Random& random) {
  Transform3x4 m = identity_transform;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[4 * row + column] = 0.4f * random.uniform(-1, 1);
    m[4 * row + 3] = random.uniform(-1, 1);
  }
  return instance_of(bottom, m);
}

std::vector<InstanceDesc> turned_instances(const std::vector<const Block*>& bottoms) {
  Random random(5);
  std::vector<InstanceDesc> descs;
  for (uint32_t i = 0; i < 40; ++i) descs.push_back(turned_instance(*bottoms[i % bottoms.size()], random));
  return descs;
}

}  // namespace

TEST_CASE("a lazy structure gives the hits of an ordinary one, in every way to trace") {
  const std::vector<std::pair<const char*, Mesh>> meshes{{"bumpy sphere", bumpy_sphere(5)},
                                                         {"small", octahedron()},
                                                         {"torus", torus(90, 60, 0.4f)},
                                                         {"mixture", mixture(6000, 3)},
                                                         {"exponential", exponential(60, 40, true)},
                                                         {"copies", copies(4000)}};
  for (const auto& [name, mesh] : meshes) {
    CAPTURE(name);
    const Block eager = build_mesh(mesh, geometry_flag::none);
    std::vector<Ray> rays = rays_around(7, 600);
    const std::vector<Ray> coherent = rays_from_eye(16);
    rays.insert(rays.end(), coherent.begin(), coherent.end());
    check_all_ways(eager, rays, [&, &lazy_mesh = mesh] { return build_lazy_mesh(lazy_mesh, geometry_flag::none); });
  }
}

TEST_CASE("instances of lazy and ordinary bottom levels give the hits of ordinary ones") {
  const Mesh sphere = bumpy_sphere(5), ring = torus(60, 40, 0.3f);
  const Block sphere_block = build_mesh(sphere), ring_block = build_mesh(ring);
  const std::vector<Ray> rays = rays_around(11, 800);
  const Block eager = build_instances(turned_instances({&sphere_block, &ring_block}));
  struct Lazy : Block {
    Lazy(Block top, Block lazy_bottom) : Block(std::move(top)), bottom(std::move(lazy_bottom)) {}
    Block bottom;
  };
  for (const bool rebraid : {false, true})
    check_all_ways(eager, rays, [&] {
      Block bottom = build_lazy_mesh(sphere);
      Block top = build_instances(turned_instances({&bottom, &ring_block}), {0, Builder::automatic, rebraid});
      CHECK(info_of(top).lazy);
      return Lazy(std::move(top), std::move(bottom));
    });
}

TEST_CASE("every builder builds lazily, with any index format, transform and several geometries") {
  const Mesh mesh = bumpy_sphere(4);
  std::vector<std::array<uint16_t, 3>> narrow;
  for (const auto& [a, b, c] : mesh.triangles)
    narrow.push_back({static_cast<uint16_t>(a), static_cast<uint16_t>(b), static_cast<uint16_t>(c)});
  std::vector<Point> soup;
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t index : triangle) soup.push_back(mesh.vertices[index]);
  const Transform3x4 turn{0.6f, -0.8f, 0, 0.1f, 0.8f, 0.6f, 0, 0, 0, 0, 1.5f, -0.3f};
  const auto geometries = [&] {
    std::vector<TriangleGeometry> all(4, mesh.geometry(geometry_flag::none));
    all[1].indices = reinterpret_cast<const std::byte*>(narrow.data());
    all[1].index_format = IndexFormat::uint16;
    all[1].transform = turn.data();
    all[2].vertices = reinterpret_cast<const std::byte*>(soup.data());
    all[2].vertex_count = static_cast<uint32_t>(soup.size());
    all[2].index_format = IndexFormat::none;
    all[2].vertex_stride = 12 | uint64_t{1} << 32;
    all[2].flags = geometry_flag::opaque;
    all[3].triangle_count = 77;  // of many more vertices
    all[3].transform = turn.data();
    return all;
  }();
  const std::vector<Ray> rays = rays_around(3, 1500);
  for (const Builder builder : all_builders())
    for (const uint32_t flags : {build_flag::none, build_flag::minimize_memory}) {
      CAPTURE(builder_name(builder), flags);
      const Block eager = build_geometries(geometries, {flags, builder});
      const Block block = build_geometries(geometries, {flags | lazy, builder});
      CHECK(differences(batch(block, rays), batch(eager, rays)) == 0);
      CHECK(differences(asked(block, rays), asked(eager, rays)) == 0);
      CHECK(info_of(block).built_parts > 1);
    }
}

TEST_CASE("only parts that rays come to are built") {
  const Mesh mesh = grid(256, 0);  // 131,072 triangles
  const Block block = build_lazy_mesh(mesh);
  const uint64_t parts = info_of(block).parts;
  CHECK(parts >= 128);
  CHECK(info_of(block).built_parts == 0);

  std::vector<Ray> rays;
  Random random(1);
  for (int i = 0; i < 500; ++i)
    rays.push_back({{random.uniform(1, 15), random.uniform(1, 15), 1}, 0, {0, 0, -1}, Box::infinity});
  const Block eager = build_mesh(mesh);
  CHECK(differences(batch(block, rays), batch(eager, rays)) == 0);
  const uint64_t corner = info_of(block).built_parts;
  CHECK(corner >= 1);
  CHECK(corner <= 6);
  CHECK(differences(alone(block, rays), batch(eager, rays)) == 0);
  CHECK(info_of(block).built_parts == corner);

  // What lies behind a hit is not built.
  Mesh layers = grid(64, 1);
  const Mesh below = grid(64, 0);
  const auto base = static_cast<uint32_t>(layers.vertices.size());
  layers.vertices.insert(layers.vertices.end(), below.vertices.begin(), below.vertices.end());
  for (const auto& [a, b, c] : below.triangles) layers.triangles.push_back({a + base, b + base, c + base});
  for (Point& vertex : layers.vertices) vertex[2] *= 100;
  const Block two = build_lazy_mesh(layers);
  batch(two, {{{30.5f, 30.4f, 200}, 0, {0, 0, -1}, Box::infinity}});
  CHECK(info_of(two).built_parts == 1);

  const std::vector<Ray> all = [] {
    std::vector<Ray> grid_rays;
    for (float y = 0.25f; y < 256; ++y)
      for (float x = 0.5f; x < 256; ++x) grid_rays.push_back({{x, y, 1}, 0, {0, 0, -1}, Box::infinity});
    return grid_rays;
  }();
  CHECK(differences(batch(block, all), batch(eager, all)) == 0);
  CHECK(info_of(block).built_parts == parts);
}

TEST_CASE("many threads trace a lazy structure at once and each part is built once") {
  const Mesh mesh = bumpy_sphere(6);  // 81,920 triangles
  const Block eager = build_mesh(mesh);
  const std::vector<Ray> rays = rays_around(2, 4000);
  const std::vector<Hit> expected = alone(eager, rays);
  const std::vector<uint8_t> expected_any = any_hits(eager, rays);
  const uint64_t touched = [&] {
    const Block one_thread = build_lazy_mesh(mesh);
    batch(one_thread, rays);
    any_hits(one_thread, rays);
    return info_of(one_thread).built_parts;
  }();
  for (int round = 0; round < 5; ++round) {
    const Block bottom = build_lazy_mesh(mesh);
    const Block top = build_instances({instance_of(bottom)});
    std::vector<size_t> wrong(8);
    std::vector<std::thread> threads;
    for (size_t k = 0; k < wrong.size(); ++k)
      threads.emplace_back([&, k] {
        if (k % 4 == 0) wrong[k] = differences(batch(bottom, rays), expected);
        if (k % 4 == 1) wrong[k] = differences(alone(bottom, rays), expected);
        if (k % 4 == 2) wrong[k] = differences(batch(top, rays), expected);
        if (k % 4 == 3) wrong[k] = any_hits(bottom, rays) != expected_any;
      });
    for (std::thread& thread : threads) thread.join();
    for (const size_t count : wrong) CHECK(count == 0);
    CHECK(info_of(bottom).built_parts == touched);
  }
}

TEST_CASE("rays from parallel loops build parts") {
  const ThreadLimit limit(4);
  const Mesh mesh = bumpy_sphere(6);
  const Block eager = build_mesh(mesh),
              block = build_lazy_mesh(mesh, geometry_flag::opaque, {lazy, Builder::lbvh_treelets});
  const std::vector<Ray> rays = rays_around(4, 6000);
  std::vector<Hit> hits(rays.size());
  parallel_for(rays.size(), 20, [&](uint64_t begin, uint64_t end) {
    TraceRequest shared;
    shared.structure = block.data();
    trace({}, shared, std::span(rays).subspan(begin, end - begin), std::span(hits).subspan(begin, end - begin));
  });
  CHECK(differences(hits, alone(eager, rays)) == 0);
}

TEST_CASE("a completed lazy structure has the bytes of an ordinary one, whatever was built before") {
  const Mesh mesh = bumpy_sphere(5);
  for (const Builder builder : {Builder::binned_sah, Builder::lbvh, Builder::lbvh_treelets}) {
    Block eager = build_mesh(mesh, geometry_flag::opaque, {0, builder});
    for (const size_t rays : {0, 1, 50, 5000}) {
      Block block = build_lazy_mesh(mesh, geometry_flag::opaque, {lazy, builder});
      const Block top = build_instances({instance_of(block)});
      batch(block, rays_around(9, rays));
      complete_structure(rays == 1 ? top.data() : block.data());
      CHECK(!info_of(block).lazy);
      CHECK(info_of(top).lazy == (rays != 1));
      CHECK(info_of(block).bytes == info_of(eager).bytes);
      const size_t body = sizeof(StructureHeader), unused = TriangleLeaf::overread_bytes;
      CHECK(std::memcmp(block.data() + body, eager.data() + body, info_of(eager).bytes - body - unused) == 0);
      CHECK(info_of(block).sah_cost == info_of(eager).sah_cost);
      const std::vector<Ray> more = rays_around(10, 500);
      CHECK(differences(batch(block, more), batch(eager, more)) == 0);
      CHECK(differences(batch(top, more), batch(eager, more)) == 0);
    }
    complete_structure(eager.data());
    CHECK(!info_of(eager).lazy);
  }
}

TEST_CASE("a top level may be updated from lazy to ordinary bottom levels and back") {
  const Mesh mesh = bumpy_sphere(5);
  const Block bottom = build_lazy_mesh(mesh), eager = build_mesh(mesh);
  Block top = build_instances({instance_of(bottom)}, build_flag::allow_update);
  const std::vector<Ray> rays = rays_around(6, 300);
  const std::vector<Hit> expected = batch(eager, rays);
  const auto refer_to = [&](const Block& to) {
    const InstanceDesc desc = instance_of(to);
    refit_top_level({&desc, 1}, {}, build_flag::allow_update, top.data(), top.span());
  };
  CHECK(info_of(top).lazy);
  refer_to(eager);
  CHECK(!info_of(top).lazy);
  CHECK(differences(batch(top, rays), expected) == 0);
  CHECK(info_of(bottom).built_parts == 0);
  refer_to(bottom);
  CHECK(info_of(top).lazy);
  CHECK(differences(batch(top, rays), expected) == 0);
  CHECK(info_of(bottom).built_parts > 0);
}

TEST_CASE("lazy builds: what is wrong is found at build time") {
  Mesh mesh = bumpy_sphere(3);
  CHECK_THROWS_WITH(build_mesh(mesh, 0, {lazy | build_flag::allow_update}), Catch::Contains("cannot allow updates"));
  Mesh wrong = mesh;
  wrong.triangles[100][1] = 1u << 20;
  CHECK_THROWS_WITH(build_mesh(wrong, 0, {lazy}), Catch::Contains("triangle 100: index 1048576 is out of range"));

  // Inactive and degenerate triangles are left out.
  mesh.vertices[5][0] = std::numeric_limits<float>::quiet_NaN();
  mesh.vertices[6][1] = Box::infinity;
  mesh.triangles[9][0] = mesh.triangles[9][1];
  const Block block = build_lazy_mesh(mesh), eager = build_mesh(mesh);
  CHECK(info_of(block).active_primitives == info_of(eager).active_primitives);
  CHECK(info_of(block).primitives == info_of(eager).primitives);
  const std::vector<Ray> rays = rays_around(8, 500);
  CHECK(differences(batch(block, rays), batch(eager, rays)) == 0);

  const Block empty = build_mesh(Mesh{}, 0, {lazy});
  CHECK(!info_of(empty).lazy);
  CHECK(differences(batch(empty, rays), std::vector<Hit>(alone(empty, rays))) == 0);
  const Block over_nothing = build_instances({instance_of(empty)});
  CHECK(!info_of(over_nothing).lazy);
}

TEST_CASE("sizes of lazy structures hold for any count and follow from counts") {
  for (uint32_t count = 1; count < 4000; count = count * 5 / 4 + 1) {
    const Mesh mesh = mixture(count, count);
    for (const uint32_t flags : {lazy, lazy | build_flag::minimize_memory, lazy | build_flag::prefer_fast_build}) {
      const Block block = build_lazy_mesh(mesh, 0, flags);
      CHECK(block.used == block.size());
      const std::vector<Ray> rays = rays_around(count, 200, 20);
      CHECK(differences(batch(block, rays), batch(build_mesh(mesh, 0), rays)) == 0);
    }
  }
}

TEST_CASE("other structures take no notice of the lazy flag") {
  const AabbGeometry boxes{};
  const std::vector<AabbGeometry> none{boxes};
  CHECK(!info_of(build_geometries(none, lazy | build_flag::allow_update)).lazy);
  CHECK(!info_of(build_instances({}, lazy)).lazy);
}
