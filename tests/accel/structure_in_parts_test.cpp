#include <rayloom/accel/part_builder.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/structure_in_parts.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <cstring>
#include <limits>

#include "check_structure.h"
#include "random.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

/// Triangles that crowd towards the origin: parts of very different sizes, some of a triangle or two.
Mesh crowded(size_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const float scale = std::ldexp(1.0f, -static_cast<int>(random.below(24)));
    const auto any = [&] { return scale * random.uniform(0.5f, 1); };
    const Point a{any(), any(), any()};
    mesh.add_triangle(a, {a[0] * 1.01f, a[1], a[2]}, {a[0], a[1] * 1.01f, a[2]});
  }
  return mesh;
}

constexpr Builder in_parts[] = {Builder::binned_sah, Builder::lbvh, Builder::lbvh_treelets};

}  // namespace

TEST_CASE("structures of many parts keep every promise of the layout") {
  const Mesh meshes[] = {crowded(90000, 131), bumpy_sphere(6)};
  for (const Mesh& mesh : meshes)
    for (const Builder builder : in_parts)
      for (const uint32_t flags : {build_flag::none, build_flag::minimize_memory, build_flag::allow_update}) {
        CAPTURE(builder_name(builder), flags);
        REQUIRE(builds_in_parts(builder));
        REQUIRE(mesh.triangles.size() > 3 * part_recipe(builder).size);
        const Block block = build_mesh(mesh, geometry_flag::opaque, {flags, builder});
        StructureChecker checker(block);
        CHECK(checker.facts.names.size() == mesh.triangles.size());
        CHECK(checker.facts.nodes <= node_bound(checker.facts.leaves));
        CHECK(block.header().sah_cost > 1);
      }
}

TEST_CASE("the instruction set does not show in a structure's bytes") {
  Mesh mesh = crowded(20000, 133);
  for (const auto& triangle : bumpy_sphere(5).triangles) mesh.triangles.push_back(triangle);
  mesh.vertices[7][1] = std::numeric_limits<float>::infinity();
  mesh.vertices[12] = {-0.0f, 0.0f, -0.0f};
  mesh.triangles[100][1] = mesh.triangles[100][0];
  const Isa before = current_isa();
  for (const Builder builder : in_parts) {
    set_isa(Isa::scalar);
    const Block plain = build_mesh(mesh, geometry_flag::opaque, {0, builder});
    for (const Isa isa : {Isa::avx2, Isa::avx512}) {
      if (!isa_supported(isa)) continue;
      set_isa(isa);
      const Block block = build_mesh(mesh, geometry_flag::opaque, {0, builder});
      CAPTURE(builder_name(builder), isa_name(isa));
      REQUIRE(block.header().bytes == plain.header().bytes);
      CHECK(std::memcmp(block.data(), plain.data(), plain.header().bytes) == 0);
    }
  }
  set_isa(before);
}

TEST_CASE("the number of threads does not show in a structure's bytes") {
  const Mesh mesh = crowded(150000, 137);
  for (const Builder builder : in_parts) {
    const auto built_by = [&](unsigned threads) {
      const ThreadLimit limit(threads);
      return build_mesh(mesh, geometry_flag::opaque, {0, builder});
    };
    const Block one = built_by(1);
    for (const unsigned threads : {2u, 3u, 16u}) {
      const Block block = built_by(threads);
      CAPTURE(builder_name(builder), threads);
      REQUIRE(block.header().bytes == one.header().bytes);
      CHECK(std::memcmp(block.data(), one.data(), one.header().bytes) == 0);
    }
  }
}

TEST_CASE("nodes have children nearly as many as fit, inner ones first") {
  const Block block = build_mesh(bumpy_sphere(6), geometry_flag::opaque, {0, Builder::lbvh});
  const StructureChecker checker(block);
  const double children = static_cast<double>(checker.facts.nodes + checker.facts.leaves - 1);
  CHECK(children / static_cast<double>(checker.facts.nodes) > 5);
  const auto& root = *reinterpret_cast<const Node8*>(block.data() + node_ref::offset(block.header().root));
  for (int i = 1; i < 8 && root.child[i] != 0; ++i)
    CHECK((node_ref::is_leaf(root.child[i]) || !node_ref::is_leaf(root.child[i - 1])));
}

TEST_CASE("a structure without active triangles has no root") {
  Mesh mesh;
  mesh.add_triangle({0, 0, 0}, {0, 0, 0}, {1, 0, 0});
  for (const Builder builder : in_parts) {
    const Block block = build_mesh(mesh, geometry_flag::opaque, {0, builder});
    CHECK(block.header().root == no_index);
    CHECK(block.header().active_count == 0);
  }
}
