// Has to fail: it compares a render with another seed's hash. Should the comparison ever stop comparing, ctest tells.

#include "picture_hash.h"

#include <catch2/catch.hpp>

using namespace rayloom;

TEST_CASE("a render of seed 2 has the bits of seed 1") {
  const test::PictureCase seed_1{"cornell", "path_tracer"};
  test::PictureCase seed_2 = seed_1;
  seed_2.seed = 2;
  CHECK(test::picture_hash(test::render_case(seed_2)) == test::read_hashes(RAYLOOM_HASHES).at(seed_1.key()));
}
