#include <rayloom/accel/asked_triangles.h>

#include <catch2/catch.hpp>

#include "random.h"

using namespace rayloom::accel;
using rayloom::accel::test::Random;

TEST_CASE("a triangle is new once, however many others are asked for") {
  for (const uint32_t names : {1u, 7u, 8u, 9u, 500u}) {
    AskedTriangles asked;
    Random random(names);
    std::set<AskedTriangles::Name> seen;
    for (uint32_t i = 0; i < 20 * names; ++i) {
      const AskedTriangles::Name name{random.below(names), random.below(2), random.below(2)};
      CHECK(asked.is_new(name) == seen.insert(name).second);
    }
  }
}
