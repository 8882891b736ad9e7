#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/tree_builder.h>

#include <catch2/catch.hpp>

#include "structures.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

TEST_CASE("builders have names that lead back to them") {
  CHECK(parse_builder("automatic") == Builder::automatic);
  CHECK(!parse_builder(""));
  CHECK(!parse_builder("Binned_SAH"));
  for (const Builder builder : all_builders()) {
    CHECK(builder != Builder::automatic);
    CHECK(parse_builder(builder_name(builder)) == builder);
  }
}

TEST_CASE("a structure tells which builder made it") {
  for (const Builder builder : all_builders()) {
    const BuildSettings settings(build_flag::none, builder);
    const Mesh mesh = icosphere(1);
    const TriangleGeometry geometry = mesh.geometry();
    Block block(bottom_level_sizes({&geometry, 1}, settings).result_bytes);
    build_bottom_level({&geometry, 1}, settings, block.span());
    CHECK(structure_info(block.data()).builder == chosen_builder(StructureKind::triangles, settings));
    CHECK(chosen_builder(StructureKind::triangles, settings) == builder);
  }
  CHECK(structure_info(build_mesh(octahedron()).data()).builder ==
        chosen_builder(StructureKind::triangles, build_flag::none));
}
