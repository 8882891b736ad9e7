#include <rayloom/accel/reinsertion.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include "check_structure.h"
#include "hard_meshes.h"
#include "random.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr BuildSettings improved{build_flag::prefer_fast_trace, Builder::reinsertion};
constexpr BuildSettings plain{build_flag::none, Builder::binned_sah};

BuiltTree tree_of(const Mesh& mesh) {
  const TriangleGeometry geometry = mesh.geometry();
  return build_tree(triangle_refs({&geometry, 1}, false),
                    tree_input(StructureKind::triangles, mesh.triangles.size(), plain));
}

struct TreeSum {
  double area = 0;
  uint32_t leaves = 0, broken = 0;
  std::set<std::pair<uint32_t, uint32_t>> ranges;
};

bool encloses(const Box& outer, const Box& inner) {
  for (int k = 0; k < 3; ++k)
    if (inner.min[k] < outer.min[k] || inner.max[k] > outer.max[k]) return false;
  return true;
}

void walk_tree(const BinaryTree& tree, uint32_t slot, TreeSum& sum) {
  const BinaryNode& node = tree[slot];
  sum.area += node.box.half_area();
  if (node.is_leaf()) {
    ++sum.leaves;
    sum.ranges.insert({node.first, node.count});
    return;
  }
  for (const uint32_t child : {slot + 1, node.right}) {
    sum.broken += !encloses(node.box, tree[child].box);
    walk_tree(tree, child, sum);
  }
  sum.broken += node.count != tree[slot + 1].count + tree[node.right].count;
}

TreeSum sum_of(const BinaryTree& tree) {
  TreeSum sum;
  walk_tree(tree, 0, sum);
  return sum;
}

}  // namespace

TEST_CASE("leaves stay, boxes enclose, areas shrink") {
  for (const size_t count : {1u, 9u, 20u, 60u, 3000u, 60000u}) {
    BuiltTree built = tree_of(mixture(count, 90));
    const TreeSum before = sum_of(built.tree);
    const TreeSum after = sum_of(reinsert(built.tree, {}));
    CHECK(after.broken == 0);
    CHECK(after.leaves == before.leaves);
    CHECK(after.ranges == before.ranges);
    CHECK(after.area <= before.area * (1 + 1e-6));
    if (count >= 3000) CHECK(after.area < 0.97 * before.area);
  }
}

TEST_CASE("rounds go on improving, and no round changes nothing") {
  const BuiltTree built = tree_of(mixture(5000, 91));
  const double none = sum_of(reinsert(built.tree, {0, 1})).area, one = sum_of(reinsert(built.tree, {1, 1})).area;
  CHECK(none == Approx(sum_of(built.tree).area));
  CHECK(one < none);
  CHECK(sum_of(reinsert(built.tree, {6, 1})).area < one);
}

TEST_CASE("a misplaced leaf finds its place") {
  // Four unit boxes in a row; the tree pairs the outer ones and the inner ones.
  const auto at = [](float x) { return Box{{x, 0, 0}, {x + 1, 1, 1}}; };
  const Box all{{0, 0, 0}, {31, 1, 1}}, left{{0, 0, 0}, {31, 1, 1}}, right{{1, 0, 0}, {30, 1, 1}};
  BinaryTree tree{{all, 0, 4, 4},   {left, 0, 2, 3},  {at(0), 0, 1, 0}, {at(30), 1, 1, 0},
                  {right, 2, 2, 6}, {at(1), 2, 1, 0}, {at(29), 3, 1, 0}};
  const double before = sum_of(tree).area;
  const TreeSum after = sum_of(reinsert(tree, {}));
  CHECK(after.leaves == 4);
  CHECK(after.area < 0.8 * before);
}

TEST_CASE("the same bytes for any number of threads (DET-07)") {
  const Mesh mesh = mixture(60000, 92);
  std::vector<std::byte> first;
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    const Block block = build_mesh(mesh, geometry_flag::opaque, improved);
    const std::vector<std::byte> bytes(block.data(), block.data() + block.used);
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
}

TEST_CASE("hits equal those of binned SAH, bit for bit") {
  for (const Mesh& mesh : {mixture(4000, 93), bumpy_sphere(4), grid(40, 1)}) {
    const Block a = build_mesh(mesh, geometry_flag::opaque, improved),
                b = build_mesh(mesh, geometry_flag::opaque, plain);
    StructureChecker checker(a);
    Random random(94);
    size_t different = 0, hits = 0;
    for (int i = 0; i < 4000; ++i) {
      const Point target = mesh.vertices[random.below(uint32_t(mesh.vertices.size()))];
      const Ray ray = ray_between({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)}, target);
      const Hit hit = trace({}, request_for(a, ray));
      hits += bool(hit);
      different += !same_bits(hit, trace({}, request_for(b, ray)));
    }
    CHECK(different == 0);
    CHECK(hits > 1000);
  }
}

TEST_CASE("equal boxes and long chains stay shallow and take no long time (B1, B2)") {
  Mesh equal;
  for (const Point& p : {Point{-1, -1, 1}, {1, -1, 1}, {0, 2, 1}}) equal.add(p);
  equal.triangles.assign(300000, {0, 1, 2});
  Mesh chain;
  for (int i = 0; i < 140 * 9; ++i) {
    const float z = std::ldexp(1.0f + 0.001f * static_cast<float>(i % 9), -(i / 9));
    chain.add_triangle({-z, -z, z}, {z, -z, z}, {0, z, z});
  }
  for (const Mesh* mesh : std::initializer_list<const Mesh*>{&equal, &chain}) {
    const Block block = build_mesh(*mesh, geometry_flag::opaque, improved);
    const StructureChecker checker(block);
    CHECK(checker.facts.depth <= max_depth);
  }
}

TEST_CASE("instances and procedurals may be improved, and updated") {
  const Block bottom = build_mesh(icosphere(1));
  Random random(95);
  std::vector<InstanceDesc> descs;
  for (int i = 0; i < 500; ++i) {
    const float s = random.uniform(0.01f, 0.5f);
    const auto at = [&] { return random.uniform(-3, 3); };
    descs.push_back(instance_of(bottom, {s, 0, 0, at(), 0, s, 0, at(), 0, 0, s, at()}));
  }
  const BuildSettings settings{build_flag::allow_update, Builder::reinsertion};
  const Block a = build_instances(descs, settings), b = build_instances(descs, plain);
  for (const bool updated : {false, true}) {
    if (updated) refit_top_level(descs, {}, settings, a.data(), a.span());
    size_t different = 0;
    for (int i = 0; i < 1000; ++i) {
      const auto any = [&] { return random.uniform(-3, 3); };
      const Ray ray = ray_between({any(), any(), any()}, {any(), any(), any()});
      different += !same_bits(trace({}, request_for(a, ray)), trace({}, request_for(b, ray)));
    }
    CHECK(different == 0);
  }
}
