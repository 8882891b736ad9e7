// Re-braided top levels: the same hits as without, every leaf of an instance below one entry, bounds kept.

#include <rayloom/accel/sizes.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <map>

#include "check_structure.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

BuildSettings rebraided(uint32_t flags = build_flag::none, Builder builder = Builder::automatic) {
  return {flags, builder, true};
}

/// A rotation from a random quaternion, scaled by axis, mirrored in every third; translated by up to `reach`.
Transform3x4 placement(Random& random, uint32_t index, float reach) {
  float q[4], length = 0;
  for (float& x : q) {
    x = random.uniform(-1, 1);
    length += x * x;
  }
  for (float& x : q) x /= std::sqrt(length);
  const auto [w, x, y, z] = q;
  const float rotation[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                                {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                                {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  Transform3x4 m;
  for (uint32_t column = 0; column < 3; ++column) {
    const float scale = random.uniform(0.5f, 2) * (index % 3 == 0 && column == 0 ? -1.0f : 1.0f);
    for (uint32_t row = 0; row < 3; ++row) m[4 * row + column] = rotation[row][column] * scale;
  }
  for (uint32_t row = 0; row < 3; ++row) m[4 * row + 3] = random.uniform(-reach, reach);
  return m;
}

/// Rings hooked into one another, a plate of boxes and a plane of large triangles through all of them.
struct Tangle {
  explicit Tangle(uint32_t geometry_flags = geometry_flag::opaque, Builder builder = Builder::automatic,
                  uint32_t instances = 60)
      : ring(torus(60, 12, 0.1f)),
        plane(moved(grid(40, 0), 0.1f, -2)),
        boxes(make_boxes()),
        bottoms{build_mesh(ring, geometry_flags, {build_flag::none, builder}),
                build_mesh(plane, geometry_flags, {build_flag::none, builder}),
                build_geometries(std::vector<AabbGeometry>{
                    {reinterpret_cast<const std::byte*>(boxes.data()), 24, boxes.size(), geometry_flags}})} {
    Random random(90);
    for (uint32_t i = 0; i < instances; ++i)
      descs.push_back(instance_of(bottoms[i < 3 ? i : i % 7 == 0], placement(random, i, 1)));
  }

  static std::vector<std::array<float, 6>> make_boxes() {
    std::vector<std::array<float, 6>> list;
    for (int i = 0; i < 400; ++i) {
      const float x = 0.1f * static_cast<float>(i % 20) - 1, y = 0.1f * static_cast<float>(i / 20) - 1;
      list.push_back({x, y, 0, x + 0.08f, y + 0.08f, 0.05f});
    }
    return list;
  }

  Mesh ring, plane;
  std::vector<std::array<float, 6>> boxes;
  Block bottoms[3];
  std::vector<InstanceDesc> descs;
};

std::vector<Ray> some_rays(size_t count, uint64_t seed) {
  Random random(seed);
  const auto any = [&](float reach) {
    return Point{random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  };
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) rays.push_back(ray_between(any(3), any(1)));
  return rays;
}

/// Calls visit(record) for every leaf.
template <class Visit>
void for_each_record(const Block& top, uint32_t ref, const Visit& visit) {
  const std::byte* address = top.data() + node_ref::offset(ref);
  if (node_ref::is_leaf(ref)) return visit(*reinterpret_cast<const InstanceRecord*>(address));
  const auto& node = *reinterpret_cast<const Node8*>(address);
  for (int i = 0; i < 8; ++i)
    if (node.bounds[0][0][i] <= node.bounds[0][1][i]) for_each_record(top, node.child[i], visit);
}

/// The leaves of a bottom level below `ref`.
void add_leaves(const std::byte* block, uint32_t ref, std::multiset<uint32_t>& leaves) {
  if (node_ref::is_leaf(ref)) return void(leaves.insert(ref));
  const auto& node = *reinterpret_cast<const Node8*>(block + node_ref::offset(ref));
  for (int i = 0; i < 8; ++i)
    if (node.bounds[0][0][i] <= node.bounds[0][1][i]) add_leaves(block, node.child[i], leaves);
}

std::vector<std::array<uint32_t, 3>> names_asked(const Block& top, const Ray& ray, uint32_t ray_flags) {
  Recorder recorder;
  trace({}, recorder.request(top, ray, ray_flags));
  std::vector<std::array<uint32_t, 3>> names;
  for (const Candidate& c : recorder.candidates)
    names.push_back({c.instance_index, c.geometry_index, c.primitive_index});
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

TEST_CASE("closest hits equal those of the unopened structure, bit for bit") {
  const Tangle tangle;
  const Block plain = build_instances(tangle.descs);
  const auto rays = some_rays(3000, 91);
  for (const Builder builder : all_builders()) {
    const Block braided = build_instances(tangle.descs, rebraided(build_flag::none, builder));
    REQUIRE(braided.header().leaf_count > 2 * plain.header().leaf_count);
    for_each_isa([&](Isa) {
      std::vector<TraceRequest> requests;
      for (const Ray& ray : rays) requests.push_back(request_for(braided, ray));
      std::vector<Hit> batch(rays.size());
      trace({}, requests, batch);
      size_t different = 0, hits = 0, verdict_differs = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        const Hit hit = trace({}, request_for(plain, rays[i]));
        different += !same_bits(hit, trace({}, requests[i])) || !same_bits(hit, batch[i]);
        const uint32_t any = ray_flag::accept_first_hit_and_end_search;
        verdict_differs += bool(trace({}, request_for(braided, rays[i], any))) != bool(hit);
        hits += bool(hit);
      }
      CHECK(different == 0);
      CHECK(verdict_differs == 0);
      CHECK(hits > rays.size() / 4);
    });
  }
}

TEST_CASE("every primitive is asked for as often as in the unopened structure, once") {
  for (const Builder builder : {Builder::automatic, Builder::spatial_splits}) {
    // Opaque ones may be split between two entries; the ray's flag makes them ask.
    const bool splits = builder == Builder::spatial_splits;
    const Tangle tangle(splits ? geometry_flag::opaque : geometry_flag::none, builder);
    const Block plain = build_instances(tangle.descs), braided = build_instances(tangle.descs, rebraided());
    REQUIRE(braided.header().leaf_count > 2 * plain.header().leaf_count);
    for_each_isa([&](Isa) {
      size_t asked = 0;
      for (const Ray& ray : some_rays(500, 92)) {
        const auto names = names_asked(braided, ray, splits ? ray_flag::force_non_opaque : 0);
        const bool once = std::adjacent_find(names.begin(), names.end()) == names.end();
        CHECK(once);
        // A procedural box may be offered to a ray that passes beside it, and not every tree offers it.
        const auto is_box = [&](const auto& name) {
          return tangle.descs[name[0]].bottom_level_address == tangle.bottoms[2].address();
        };
        auto triangles = names, expected = names_asked(plain, ray, splits ? ray_flag::force_non_opaque : 0);
        std::erase_if(triangles, is_box);
        std::erase_if(expected, is_box);
        CHECK(triangles == expected);
        asked += names.size();
      }
      CHECK(asked > 1000);
    });
  }
}

TEST_CASE("each leaf of an instance lies below exactly one of its entries") {
  const Tangle tangle;
  const Block braided = build_instances(tangle.descs, rebraided());
  std::map<uint32_t, std::multiset<uint32_t>> below;
  size_t at_nodes = 0, at_leaves = 0;
  for_each_record(braided, braided.header().root, [&](const InstanceRecord& record) {
    const auto* block = reinterpret_cast<const std::byte*>(record.bottom_level_address);
    add_leaves(block, record.entry ? record.entry : header_of(block).root, below[record.instance_index]);
    if (record.entry) ++(node_ref::is_leaf(record.entry) ? at_leaves : at_nodes);
  });
  CHECK(at_nodes > 100);
  CHECK(at_leaves > 0);
  REQUIRE(below.size() == tangle.descs.size());
  size_t wrong = 0;
  for (const auto& [index, leaves] : below) {
    const auto* block = reinterpret_cast<const std::byte*>(tangle.descs[index].bottom_level_address);
    std::multiset<uint32_t> all;
    add_leaves(block, header_of(block).root, all);
    wrong += all != leaves;
  }
  CHECK(wrong == 0);
}

TEST_CASE("sizes follow from counts and flags, and hold") {
  Tangle tangle(geometry_flag::opaque, Builder::automatic, 200);
  for (const size_t count : {200u, 61u, 17u, 3u, 2u, 1u, 0u}) {
    tangle.descs.resize(count);
    for (const uint32_t flags : {build_flag::none, build_flag::minimize_memory, build_flag::prefer_fast_build}) {
      const Block braided = build_instances(tangle.descs, rebraided(flags));
      const StructureChecker checker(braided);
      CHECK(checker.facts.leaves <= rebraid_bound(count));
      const StructureInfo info = structure_info(braided.data());
      CHECK(info.primitives == count);
      CHECK(info.active_primitives == count);
    }
  }
  uint64_t before = 0;
  for (uint64_t count = 0; count < 3000; ++count) {
    const uint64_t bytes = top_level_sizes(count, rebraided()).result_bytes;
    CHECK(bytes >= before);
    CHECK(bytes >= top_level_sizes(count, build_flag::none).result_bytes);
    before = bytes;
  }
}

TEST_CASE("instances that overlap nothing, or are ill conditioned, stay whole") {
  const Mesh mesh = bumpy_sphere(3);
  const Block bottom = build_mesh(mesh);
  std::vector<InstanceDesc> apart;
  for (int i = 0; i < 30; ++i)
    apart.push_back(instance_of(bottom, {1, 0, 0, 5 * static_cast<float>(i), 0, 1, 0, 0, 0, 0, 1, 0}));
  CHECK(build_instances(apart, rebraided()).header().leaf_count == 30);
  const Tangle tangle;
  auto flat = tangle.descs;
  for (InstanceDesc& desc : flat)
    for (auto& row : desc.transform) row[1] = row[0] + 1e-5f * row[1];
  const Block braided = build_instances(flat, rebraided());
  CHECK(braided.header().leaf_count == braided.header().active_count);
  for (const Ray& ray : some_rays(300, 93))
    CHECK(same_bits(trace({}, request_for(braided, ray)), trace({}, request_for(build_instances(flat), ray))));
}

TEST_CASE("the same bytes for any number of threads (DET-07)") {
  const Tangle tangle(geometry_flag::opaque, Builder::automatic, 500);
  std::vector<std::byte> first;
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    const Block block = build_instances(tangle.descs, rebraided());
    const std::vector<std::byte> bytes(block.data(), block.data() + block.used);
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
}

TEST_CASE("a structure that allows updates is not opened; one that is opened refuses them") {
  const Tangle tangle;
  const BuildSettings updatable = rebraided(build_flag::allow_update);
  const Block whole = build_instances(tangle.descs, updatable);
  CHECK(whole.header().leaf_count == tangle.descs.size());
  CHECK(refit_top_level(tangle.descs, {}, updatable, whole.data(), whole.span()) == whole.used);
  const Block opened = build_instances(tangle.descs, rebraided());
  CHECK_THROWS_WITH(refit_top_level(tangle.descs, {}, rebraided(), opened.data(), opened.span()),
                    Catch::Contains("ALLOW_UPDATE"));
}
