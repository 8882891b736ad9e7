// Spatial splits: the same hits as the tree without them, references that cover their triangles, bounds kept.

#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <map>

#include "check_structure.h"
#include "hard_meshes.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr BuildSettings with_splits{build_flag::prefer_fast_trace, Builder::spatial_splits};
constexpr BuildSettings without_splits{build_flag::none, Builder::binned_sah};

Mesh joined(Mesh mesh, const Mesh& other) {
  const auto base = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return mesh;
}

/// A fine sphere between walls of two triangles each.
Mesh sphere_in_box() { return joined(cube(0), moved(bumpy_sphere(4), 0.6f, 0)); }

size_t references(const Block& block) {
  const StructureChecker checker(block);
  return checker.facts.primitives;
}

Point some_point(const Mesh& mesh, Random& random) {
  const auto& t = mesh.triangles[random.below(uint32_t(mesh.triangles.size()))];
  const Point &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  if (random.chance(3)) return a;
  const float u = random.uniform(0, 1), v = random.chance(2) ? 0 : (1 - u) * random.uniform(0, 1);
  Point p;
  for (int k = 0; k < 3; ++k) p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
  if (random.chance(2))
    for (float& x : p) x = random.nudged(x, 4);
  return p;
}

/// Through vertices, edges and insides; from everywhere; along the plane of a triangle.
Ray some_ray(const Mesh& mesh, Random& random) {
  const Point target = some_point(mesh, random);
  if (random.chance(3)) return ray_between(some_point(mesh, random), target);
  Ray ray = ray_between({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)}, target);
  if (random.chance(4)) ray.direction[random.below(3)] = 0;
  if (random.chance(4)) ray.t_max = random.uniform(0, 2);
  return ray;
}

void check_same_hits(const Mesh& mesh, size_t rays, uint64_t seed) {
  const Block split = build_mesh(mesh, geometry_flag::opaque, with_splits);
  const Block plain = build_mesh(mesh, geometry_flag::opaque, without_splits);
  REQUIRE(references(split) > references(plain));
  for_each_isa([&](Isa) {
    Random random(seed);
    size_t different = 0, hits = 0, verdict_differs = 0;
    for (size_t i = 0; i < rays; ++i) {
      const Ray ray = some_ray(mesh, random);
      const Hit hit = trace({}, request_for(split, ray));
      different += !same_bits(hit, trace({}, request_for(plain, ray)));
      const uint32_t any = ray_flag::accept_first_hit_and_end_search;
      verdict_differs += bool(trace({}, request_for(split, ray, any))) != bool(hit);
      hits += bool(hit);
    }
    CHECK(different == 0);
    CHECK(verdict_differs == 0);
    CHECK(hits > rays / 4);
  });
}

/// For each triangle the boxes of the references that stand for it.
std::map<uint32_t, std::vector<Box>> boxes_of(const BuiltTree& built) {
  std::map<uint32_t, std::vector<Box>> boxes;
  for (const BinaryNode& node : built.tree) {
    if (node.count == 0 || !node.is_leaf()) continue;
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      Box box;
      box.extend(built.refs[i].min, built.refs[i].max);
      boxes[built.refs[i].primitive].push_back(box);
    }
  }
  return boxes;
}

bool holds(const Box& box, const double (&p)[3]) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < double{box.min[k]} || p[k] > double{box.max[k]}) return false;
  return true;
}

BuiltTree split_tree_of(const TriangleGeometry& geometry) {
  TreeInput input = tree_input(StructureKind::triangles, geometry.triangle_count, with_splits);
  input.triangles = {&geometry, 1};
  return build_tree(triangle_refs({&geometry, 1}, false), input);
}

/// Coordinates of few bits, so that the points tested below are exact in double.
Mesh on_coarse_grid(Mesh mesh) {
  for (Point& p : mesh.vertices)
    for (float& x : p) x = std::round(x * 4096) / 4096;
  return mesh;
}

}  // namespace

TEST_CASE("hits equal those of the tree without splits, bit for bit") {
  check_same_hits(mixture(3000, 51), 4000, 52);
  check_same_hits(sphere_in_box(), 4000, 53);
  check_same_hits(joined(cube(0), moved(torus(60, 30, 0.3f), 0.5f, 0.1f)), 4000, 54);
}

TEST_CASE("hits equal at any scale and far from the origin") {
  for (const float scale : {1e-30f, 1e-6f, 1e5f, 1e30f}) {
    const Mesh mesh = moved(mixture(500, 55), scale, 0);
    const Block split = build_mesh(mesh, geometry_flag::opaque, with_splits), plain = build_mesh(mesh);
    Random random(56);
    size_t different = 0, hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Ray ray = ray_between(some_point(mesh, random), some_point(mesh, random));
      const Hit hit = trace({}, request_for(split, ray));
      hits += bool(hit);
      different += !same_bits(hit, trace({}, request_for(plain, ray)));
    }
    CHECK(different == 0);
    CHECK(hits > 200);
  }
  check_same_hits(moved(mixture(2000, 57), 0.25f, 1), 2000, 58);
}

TEST_CASE("closed meshes between large walls do not leak") {
  const Mesh mesh = sphere_in_box();
  const Block block = build_mesh(mesh, geometry_flag::opaque, with_splits);
  Random random(59);
  size_t leaks = 0;
  for (int i = 0; i < 5000; ++i)
    leaks += !trace({}, request_for(block, ray_between({0.01f, 0.02f, 0.03f}, some_point(mesh, random))));
  CHECK(leaks == 0);
}

TEST_CASE("a triangle's references cover it, exactly, and end where it ends") {
  const Mesh mesh = on_coarse_grid(mixture(2000, 60));
  const TriangleGeometry geometry = mesh.geometry();
  size_t uncovered = 0, split = 0, outside = 0;
  for (const auto& [primitive, boxes] : boxes_of(split_tree_of(geometry))) {
    split += boxes.size() > 1;
    const InputTriangle corners = read_triangle(geometry, primitive);
    const auto& v = corners.vertex;
    Box whole;
    for (const auto& corner : v) whole.extend(corner);
    for (const Box& box : boxes)
      for (int k = 0; k < 3; ++k) outside += box.min[k] < whole.min[k] || box.max[k] > whole.max[k];
    for (int i = 0; i <= 64; ++i)
      for (int j = 0; i + j <= 64; j += 8) {
        double p[3];
        for (int k = 0; k < 3; ++k)
          p[k] = (i * double{v[0][k]} + j * double{v[1][k]} + (64 - i - j) * double{v[2][k]}) / 64;
        uncovered += std::none_of(boxes.begin(), boxes.end(), [&](const Box& box) { return holds(box, p); });
      }
  }
  CHECK(split > 100);
  CHECK(uncovered == 0);
  CHECK(outside == 0);
}

TEST_CASE("no leaf names a triangle twice, and none is left out") {
  const Mesh mesh = mixture(5000, 61);
  const TriangleGeometry geometry = mesh.geometry();
  const BuiltTree built = split_tree_of(geometry);
  std::set<uint32_t> named;
  size_t repeated = 0;
  for (const BinaryNode& node : built.tree) {
    if (node.count == 0 || !node.is_leaf()) continue;
    CHECK(node.count <= leaf_width);
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      repeated += i > node.first && !name_less(built.refs[i - 1], built.refs[i]);
      named.insert(built.refs[i].primitive);
    }
  }
  CHECK(repeated == 0);
  CHECK(named.size() == 5000);
}

TEST_CASE("leaves mark the triangles that lie in several") {
  const Mesh mesh = mixture(1000, 62);
  const Block block = build_mesh(mesh, geometry_flag::opaque, with_splits);
  std::map<uint32_t, std::pair<size_t, size_t>> marks;  // by primitive: times named, times marked
  const std::function<void(uint32_t)> visit = [&](uint32_t ref) {
    if (node_ref::is_leaf(ref)) {
      const auto& leaf = *reinterpret_cast<const TriangleLeaf*>(block.data() + node_ref::offset(ref));
      for (uint32_t lane = 0; lane < leaf.count; ++lane) {
        ++marks[leaf.primitive[lane]].first;
        marks[leaf.primitive[lane]].second += (leaf.geometry_of(lane) >> 24 & geometry_flag::split) != 0;
        CHECK((leaf.geometry_of(lane) >> 24 & geometry_flag::opaque) != 0);
      }
      return;
    }
    const auto& node = *reinterpret_cast<const Node8*>(block.data() + node_ref::offset(ref));
    for (int i = 0; i < 8; ++i)
      if (node.bounds[0][0][i] <= node.bounds[0][1][i]) visit(node.child[i]);
  };
  visit(block.header().root);
  size_t unmarked = 0, several = 0;
  for (const auto& [primitive, mark] : marks) {
    several += mark.first > 1;
    unmarked += mark.first > 1 && mark.second != mark.first;
  }
  CHECK(several > 100);
  CHECK(unmarked == 0);
}

TEST_CASE("triangles that are not opaque stay whole, so each is asked for once") {
  const Mesh mesh = mixture(2000, 63);
  const Block block = build_mesh(mesh, geometry_flag::none, with_splits);
  CHECK(references(block) == 2000);
  Random random(64);
  for (int i = 0; i < 200; ++i) {
    Recorder recorder;
    trace({}, recorder.request(block, some_ray(mesh, random)));
    auto trail = recorder.trail();
    std::sort(trail.begin(), trail.end());
    CHECK(std::adjacent_find(trail.begin(), trail.end()) == trail.end());
  }
  const Mesh few = mixture(100, 67);
  const std::vector<TriangleGeometry> both{mesh.geometry(), few.geometry(geometry_flag::none)};
  CHECK(references(build_geometries(both, with_splits)) > 2100);
}

TEST_CASE("forced to ask, a ray asks each split triangle once") {
  const Mesh mesh = mixture(2000, 63);
  const Block split = build_mesh(mesh, geometry_flag::opaque, with_splits);
  const Block plain = build_mesh(mesh, geometry_flag::opaque, without_splits);
  REQUIRE(references(split) > 2100);
  InstanceDesc forced = instance_of(split);
  forced.flags = instance_flag::force_non_opaque;
  const Block top = build_instances({forced});
  std::vector<std::vector<std::array<uint32_t, 4>>> first;
  for_each_isa([&](Isa) {
    Random random(68);
    std::vector<std::vector<std::array<uint32_t, 4>>> trails;
    size_t asked = 0, most = 0;
    for (int i = 0; i < 300; ++i) {
      const Ray ray = some_ray(mesh, random);
      Recorder expected, by_ray, by_instance;
      trace({}, expected.request(plain, ray, ray_flag::force_non_opaque));
      trace({}, by_ray.request(split, ray, ray_flag::force_non_opaque));
      trace({}, by_instance.request(top, ray));
      trails.push_back(by_ray.trail());
      CHECK(by_instance.trail() == trails.back());
      auto all = expected.trail(), once = by_ray.trail();
      std::sort(all.begin(), all.end());
      std::sort(once.begin(), once.end());
      CHECK(once == all);
      asked += once.size();
      most = std::max(most, once.size());
    }
    CHECK(asked > 1000);
    CHECK(most > 8);  // more than the memory holds without allocating
    if (first.empty()) first = trails;
    CHECK(trails == first);
  });
}

TEST_CASE("the same bytes for any number of threads (DET-07)") {
  const Mesh mesh = joined(mixture(30000, 65), sphere_in_box());
  std::vector<std::byte> first;
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    const Block block = build_mesh(mesh, geometry_flag::opaque, with_splits);
    const std::vector<std::byte> bytes(block.data(), block.data() + block.used);
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
}

TEST_CASE("structures stay within their sizes, which follow from counts and flags") {
  for (const size_t count : {1u, 2u, 8u, 9u, 10u, 17u, 100u, 1000u, 20000u}) {
    const Mesh mesh = mixture(count, 66);
    const Block block = build_mesh(mesh, geometry_flag::opaque, with_splits);
    CHECK(block.used <= block.size());
    CHECK(references(block) <= split_reference_bound(count));
    const TriangleGeometry geometry = mesh.geometry();
    const auto bytes = [&](const BuildSettings& settings) {
      return bottom_level_sizes({&geometry, 1}, settings).result_bytes;
    };
    CHECK(bytes(with_splits) == block.size());
    CHECK(bytes({build_flag::minimize_memory, Builder::spatial_splits}) <= block.size());
  }
  uint64_t before = 0;
  for (uint32_t count = 0; count < 3000; ++count) {
    TriangleGeometry geometry;
    geometry.triangle_count = count;
    const uint64_t bytes = bottom_level_sizes({&geometry, 1}, with_splits).result_bytes;
    CHECK(bytes >= before);
    before = bytes;
  }
}

TEST_CASE("splits are for triangles that never move") {
  using namespace build_flag;
  const auto chosen = [](StructureKind kind, const BuildSettings& settings) { return chosen_builder(kind, settings); };
  CHECK(chosen(StructureKind::triangles, {none, Builder::spatial_splits}) == Builder::spatial_splits);
  CHECK(chosen(StructureKind::triangles, {allow_update, Builder::spatial_splits}) == Builder::binned_sah);
  CHECK(chosen(StructureKind::procedurals, with_splits) == Builder::binned_sah);
  CHECK(chosen(StructureKind::instances, with_splits) == Builder::binned_sah);
}
