#include <rayloom/accel/sizes.h>
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

constexpr float infinity = Box::infinity;
constexpr Ray upward{{0, 0, 0}, 0, {0, 0, 1}, infinity};

/// A triangle around the z axis at height z.
void add_layer(Mesh& mesh, float z) { mesh.add_triangle({-1, -1, z}, {1, -1, z}, {0, 2, z}); }

Mesh layers(std::initializer_list<float> heights) {
  Mesh mesh;
  for (const float z : heights) add_layer(mesh, z);
  return mesh;
}

Mesh soup(size_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    Point c;
    for (float& x : c) x = random.uniform(-1, 1);
    const auto near = [&] {
      Point p = c;
      for (float& x : p) x += random.uniform(-0.02f, 0.02f);
      return p;
    };
    mesh.add_triangle(near(), near(), near());
  }
  return mesh;
}

bool same_bytes(const Block& a, const Block& b) {
  return a.used == b.used && std::memcmp(a.data(), b.data(), a.used) == 0;
}

}  // namespace

TEST_CASE("the same bytes for any number of threads (DET-07)") {
  const Mesh mesh = soup(200000, 31);
  const Block bottom = build_mesh(icosphere(1));
  std::vector<InstanceDesc> descs;
  Random random(32);
  for (int i = 0; i < 30000; ++i) {
    descs.push_back(instance_of(bottom));
    for (auto& row : descs.back().transform) row[3] = random.uniform(-100, 100);
  }
  const auto build_with = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    REQUIRE(thread_limit() == threads);
    auto result = std::pair{build_mesh(mesh), build_instances(descs)};
    CHECK(threads_seen() <= threads);
    if (threads > 1) CHECK(threads_seen() > 1);
    return result;
  };
  const auto one = build_with(1);
  for (const unsigned threads : {2u, 3u, 7u}) {
    const auto many = build_with(threads);
    CHECK(same_bytes(one.first, many.first));
    CHECK(same_bytes(one.second, many.second));
  }
}

TEST_CASE("the same bytes whatever memory held before") {
  const std::vector<Mesh> meshes = {icosphere(3), soup(3000, 33), soup(5, 34)};
  std::vector<TriangleGeometry> geometries;  // leaves of one geometry and of several
  for (const Mesh& mesh : meshes) geometries.push_back(mesh.geometry());
  for (const Builder builder : all_builders())
    for (const uint32_t flags : {build_flag::none, build_flag::allow_update, build_flag::minimize_memory}) {
      CAPTURE(builder_name(builder), flags);
      const BuildSettings settings(flags, builder);
      const auto built_over = [&](int fill) {
        std::vector<std::byte> dirt(1 << 20, static_cast<std::byte>(fill));  // what scratch memory is made of
        dirt = {};
        Block block(bottom_level_sizes(std::span<const TriangleGeometry>(geometries), settings).result_bytes);
        std::memset(block.data(), fill, block.span().size());
        block.used = build_bottom_level(std::span<const TriangleGeometry>(geometries), settings, block.span());
        return block;
      };
      CHECK(same_bytes(built_over(0), built_over(0xFF)));
    }
}

TEST_CASE("a structure holds every triangle once, inside its boxes") {
  for (const size_t count : {1u, 2u, 7u, 8u, 9u, 16u, 17u, 63u, 64u, 65u, 1000u, 20000u}) {
    CAPTURE(count);
    const Mesh mesh = soup(count, 33);
    const Block block = build_mesh(mesh);
    const StructureChecker checker(block);
    CHECK(checker.facts.primitives == count);
    CHECK(checker.facts.leaves <= leaf_budget(count, StructureKind::triangles, 0));
    CHECK(checker.facts.nodes <= node_bound(checker.facts.leaves));
  }
}

TEST_CASE("sizes suffice, grow with the counts and shrink with MINIMIZE_MEMORY (PB-01 to PB-04, BF-05)") {
  uint64_t before[2] = {0, 0};
  for (uint32_t count = 0; count < 3000; count = count < 100 ? count + 1 : count * 2) {
    TriangleGeometry geometry;
    geometry.triangle_count = count;
    const auto bytes = [&](uint32_t flags) { return bottom_level_sizes({&geometry, 1}, flags).result_bytes; };
    const uint64_t now[2] = {bytes(build_flag::none), bytes(build_flag::minimize_memory)};
    CHECK(now[0] >= before[0]);
    CHECK(now[1] >= before[1]);
    CHECK(now[1] <= now[0]);
    CHECK(now[1] >= structure_alignment);
    std::copy_n(now, 2, before);
    if (count == 0) continue;
    const Mesh mesh = soup(count, 34);  // Block holds exactly result_bytes
    for (const uint32_t flags : {build_flag::none, build_flag::minimize_memory})
      StructureChecker(build_mesh(mesh, geometry_flag::opaque, flags));
  }
}

TEST_CASE("sizes read no geometry and check only the limits (PB-02, CAP-09)") {
  AabbGeometry boxes;
  boxes.boxes = reinterpret_cast<const std::byte*>(1);
  boxes.box_count = max_primitives;
  CHECK(bottom_level_sizes({&boxes, 1}, 0).result_bytes > max_primitives * 24);
  boxes.box_count = max_primitives + 1;
  CHECK_THROWS_AS(bottom_level_sizes({&boxes, 1}, 0), InputError);
  boxes.box_count = ~uint64_t{0};
  CHECK_THROWS_AS(bottom_level_sizes({&boxes, 1}, 0), InputError);
  TriangleGeometry half[3];
  for (auto& g : half) g.triangle_count = 1u << 28;
  CHECK_NOTHROW(bottom_level_sizes(std::span(half, 2), 0));
  CHECK_THROWS_AS(bottom_level_sizes(std::span(half, 3), 0), InputError);
  CHECK_NOTHROW(top_level_sizes(max_instances, 0));
  CHECK_THROWS_AS(top_level_sizes(max_instances + 1, 0), InputError);
}

TEST_CASE("a structure may be moved") {
  const Mesh mesh = soup(5000, 35);
  const Block block = build_mesh(mesh);
  Block copy(block.size());
  std::memcpy(copy.data(), block.data(), block.used);
  Block original = build_mesh(mesh);
  std::memset(original.data(), 0, original.size());
  Random random(36);
  for (int i = 0; i < 500; ++i) {
    const auto any = [&] { return random.uniform(-1, 1); };
    const Ray ray = ray_between({any(), any(), any()}, {any(), any(), any()});
    REQUIRE(same_bits(trace({}, request_for(block, ray)), trace({}, request_for(copy, ray))));
  }
}

TEST_CASE("addresses may count from a base") {
  const Block bottom = build_mesh(layers({1}));
  const AddressSpace space{bottom.data() - 4096};
  InstanceDesc desc = instance_of(bottom);
  desc.bottom_level_address = 4096;
  Block top(top_level_sizes(1, 0).result_bytes);
  build_top_level({&desc, 1}, space, 0, top.span());
  CHECK(trace(space, request_for(top, upward)).t == 1);
}

TEST_CASE("empty inputs give structures that always miss (BI-19, PB-08, TR-21)") {
  const Block none = build_geometries(std::vector<TriangleGeometry>{});
  const Block zero = build_geometries(std::vector<TriangleGeometry>(3));
  const Block no_boxes = build_geometries(std::vector<AabbGeometry>(2));
  for (const Block* block : {&none, &zero, &no_boxes}) {
    CHECK(!trace({}, request_for(*block, upward)));
    CHECK(structure_info(block->data()).active_primitives == 0);
  }
  CHECK(structure_info(zero.data()).geometries == 3);
  CHECK(structure_info(no_boxes.data()).procedural);
}

TEST_CASE("vertices may be strided, unaligned, indexed with 16 or 32 bits or not at all (BI-05, BI-12, BI-13, BI-15)") {
  const Mesh mesh = layers({3, 1, 2});
  std::vector<std::byte> strided(1 + 9 * 20, std::byte{0xFF});
  for (int i = 0; i < 9; ++i) std::memcpy(strided.data() + 1 + 20 * i, mesh.vertices[i].data(), 12);
  TriangleGeometry geometry;
  geometry.vertices = strided.data() + 1;
  geometry.vertex_stride = 0xFFFFFFFF00000000u + 20;
  geometry.vertex_count = 9;
  geometry.triangle_count = 3;
  CHECK(trace({}, request_for(build_geometries(std::vector{geometry}), upward)).primitive_index == 1);

  const uint16_t short_indices[] = {3, 4, 5, 0, 1, 2, 6, 7, 8};
  geometry.indices = reinterpret_cast<const std::byte*>(short_indices);
  geometry.index_format = IndexFormat::uint16;
  CHECK(trace({}, request_for(build_geometries(std::vector{geometry}), upward)).primitive_index == 0);

  std::vector<std::byte> unaligned(1 + 36);
  const uint32_t long_indices[] = {0, 1, 2, 6, 7, 8, 3, 4, 5};
  std::memcpy(unaligned.data() + 1, long_indices, 36);
  geometry.indices = unaligned.data() + 1;
  geometry.index_format = IndexFormat::uint32;
  CHECK(trace({}, request_for(build_geometries(std::vector{geometry}), upward)).primitive_index == 2);
}

TEST_CASE("a geometry's transform is applied at the build and its inputs may go (BI-16, BI-18)") {
  auto mesh = std::make_unique<Mesh>(layers({1}));
  auto transform = std::make_unique<Transform3x4>(Transform3x4{2, 0, 0, 0.25f, 0, 3, 0, 0, 0, 0, 4, 0.5f});
  TriangleGeometry geometry = mesh->geometry();
  geometry.transform = transform->data();
  const Block block = build_geometries(std::vector{geometry});
  mesh.reset();
  transform.reset();
  CHECK(trace({}, request_for(block, upward)).t == 4.5f);
  const StructureInfo info = structure_info(block.data());
  CHECK(info.bounds_min[0] == -1.75f);
  CHECK(info.bounds_max[1] == 6);
}

TEST_CASE("a triangle with NaN or infinity is inactive and keeps its index (PR-01, PR-03, PR-06, PR-07)") {
  for (int vertex = 0; vertex < 3; ++vertex)
    for (int axis = 0; axis < 3; ++axis)
      for (const float bad : {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity}) {
        Mesh mesh = layers({1, 2});
        mesh.vertices[vertex][axis] = bad;
        const Block block = build_mesh(mesh);
        CHECK(trace({}, request_for(block, upward)).primitive_index == 1);
        CHECK(structure_info(block.data()).primitives == 2);
        CHECK(structure_info(block.data()).active_primitives == 1);
      }
  const Mesh mesh = layers({1, 2});
  Transform3x4 transform = identity_transform;
  transform[1] = std::numeric_limits<float>::quiet_NaN();
  TriangleGeometry geometries[] = {mesh.geometry(), mesh.geometry()};
  geometries[0].transform = transform.data();
  const Block block = build_geometries(std::vector(geometries, geometries + 2));
  CHECK(trace({}, request_for(block, upward)).geometry_index == 1);
}

TEST_CASE("degenerate triangles are never hit, and kept for updates only (PR-09, PR-10)") {
  Mesh mesh = layers({1, 2, 3, 4});
  mesh.vertices[1] = mesh.vertices[0];                                                        // a line
  mesh.vertices[3] = mesh.vertices[4] = mesh.vertices[5] = {0, 0, 2};                         // a point on the ray
  mesh.vertices[6] = {-1, 0, 3}, mesh.vertices[7] = {1, 0, 3}, mesh.vertices[8] = {3, 0, 3};  // through the ray
  for (const uint32_t flags : {build_flag::none, build_flag::allow_update}) {
    const Block block = build_mesh(mesh, geometry_flag::none, flags);
    for_each_isa([&](Isa) {
      Recorder recorder;
      trace({}, recorder.request(block, upward));
      REQUIRE(recorder.candidates.size() == 1);
      CHECK(recorder.candidates[0].primitive_index == 3);
    });
    CHECK(structure_info(block.data()).active_primitives == (flags ? 4 : 2));
  }
}

TEST_CASE("procedural boxes: inactive, inverted, infinite, repeated (PR-02, PR-12, BI-20, BI-21)") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  struct Padded {
    float bounds[6];
    float extra[2];
  };
  const Padded boxes[] = {{{nan, -1, 1, 1, 1, 2}, {}},
                          {{-1, -1, 3, 1, 1, 1}, {}},  // inverted in z: the point (0, 0, 2)
                          {{-infinity, -infinity, 5, infinity, infinity, 5}, {}},
                          {{-1, nan, 1, 1, 1, 2}, {}}};
  AabbGeometry geometry{reinterpret_cast<const std::byte*>(boxes), sizeof(Padded), 4, geometry_flag::opaque};
  const Block block = build_geometries(std::vector{geometry});
  CHECK(structure_info(block.data()).active_primitives == 2);
  Recorder recorder;
  trace({}, recorder.request(block, upward));
  std::set<uint32_t> seen;
  for (const Candidate& c : recorder.candidates) seen.insert(c.primitive_index);
  CHECK(seen.count(2) == 1);
  CHECK(seen.count(0) + seen.count(3) == 0);

  geometry = {reinterpret_cast<const std::byte*>(boxes[1].bounds), 0, 20, geometry_flag::opaque};
  const Block repeated = build_geometries(std::vector{geometry});
  Recorder all;
  trace({}, all.request(repeated, upward));
  CHECK(all.candidates.size() == 20);
}

TEST_CASE("bad input is refused with its place and rule") {
  const Mesh mesh = layers({1, 2});
  const auto with = [&](auto change) {
    std::vector<TriangleGeometry> geometries{mesh.geometry(), mesh.geometry()};
    change(geometries[1]);
    return geometries;
  };
  const uint32_t indices[] = {0, 1, 2, 3, 812, 5};
  CHECK_THROWS_WITH(build_geometries(with([&](auto& g) { g.indices = reinterpret_cast<const std::byte*>(indices); })),
                    Catch::Contains("geometries[1]: triangle 1") &&
                        Catch::Contains("index 812 is out of range, the geometry has 6 vertices"));
  CHECK_THROWS_WITH(build_geometries(with([](auto& g) { g.vertices = nullptr; })), Catch::Contains("geometries[1]"));
  CHECK_THROWS_WITH(build_geometries(with([](auto& g) { g.indices = nullptr; })), Catch::Contains("geometries[1]"));
  CHECK_THROWS_WITH(build_geometries(with([](auto& g) { g.index_format = IndexFormat::none, g.triangle_count = 3; })),
                    Catch::Contains("need 9 vertices, the geometry has 6"));
  AabbGeometry no_boxes;
  no_boxes.box_count = 1;
  CHECK_THROWS_AS(build_geometries(std::vector{no_boxes}), InputError);

  const TriangleGeometry geometry = mesh.geometry();
  Block block(bottom_level_sizes({&geometry, 1}, 0).result_bytes + structure_alignment);
  CHECK_THROWS_WITH(build_bottom_level({&geometry, 1}, 0, block.span().subspan(64)), Catch::Contains("aligned"));
  CHECK_THROWS_WITH(build_bottom_level({&geometry, 1}, 0, block.span().first(256)), Catch::Contains("256 bytes"));
}

TEST_CASE("structure_info tells what was built and refuses what is none") {
  const Mesh mesh = soup(1000, 37);
  const Block block = build_mesh(mesh, geometry_flag::opaque, build_flag::prefer_fast_trace);
  const StructureInfo info = structure_info(block.data());
  CHECK(info.bytes == block.used);
  CHECK(info.build_flags == build_flag::prefer_fast_trace);
  CHECK(info.primitives == 1000);
  CHECK(info.geometries == 1);
  CHECK(info.depth >= 3);
  CHECK(info.sah_cost > 1);
  CHECK(info.sah_cost < static_cast<double>(info.nodes + info.leaves));
  CHECK_THROWS_AS(structure_info(nullptr), InputError);
  CHECK_THROWS_AS(structure_info(block.data() + 32), InputError);
  CHECK_THROWS_AS(structure_info(block.data() + 1), InputError);
}
