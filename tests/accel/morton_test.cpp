#include <rayloom/accel/morton.h>
#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <tuple>

#include "random.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

PrimitiveRef ref_at(float x, float y, float z, uint32_t primitive) {
  Box box;
  box.extend({x, y, z});
  return make_primitive_ref(box, 0, primitive);
}

/// `dense` of the references lie within 1e-4 of a corner of the unit cube, where 33 bits do not tell them apart.
PrimitiveRefs clustered(size_t count, size_t dense, uint64_t seed) {
  Random random(seed);
  PrimitiveRefs refs;
  for (size_t i = 0; i < count; ++i) {
    const float size = i < dense ? 1e-4f : 1.0f;
    const auto any = [&] { return size * random.uniform(0, 1); };
    refs.push_back(ref_at(any(), any(), any(), static_cast<uint32_t>(i)));
  }
  return refs;
}

}  // namespace

TEST_CASE("a code interleaves its coordinates' bits, x first") {
  CHECK(morton_code(0, 0, 0) == 0);
  CHECK(morton_code(1, 0, 0) == 4);
  CHECK(morton_code(0, 1, 0) == 2);
  CHECK(morton_code(0, 0, 1) == 1);
  CHECK(morton_code(0x1FFFFF, 0x1FFFFF, 0x1FFFFF) == 0x7FFFFFFFFFFFFFFF);
  Random random(71);
  for (int i = 0; i < 1000; ++i) {
    const uint32_t cell[3] = {random.below(1u << 21), random.below(1u << 21), random.below(1u << 21)};
    uint64_t expected = 0;
    for (int bit = 21; bit-- > 0;)
      for (const uint32_t c : cell) expected = expected << 1 | (c >> bit & 1);
    REQUIRE(morton_code(cell[0], cell[1], cell[2]) == expected);
  }
}

TEST_CASE("the grid spans the centres and tells 63 bits apart") {
  const PrimitiveRefs refs{ref_at(0, 0, 0, 0), ref_at(1, 1, 1, 1), ref_at(0x1p-20f, 0, 0, 2),
                           ref_at(0, 0, 0x1p-20f, 3)};
  const auto keys = morton_keys(refs);
  CHECK(keys[0].code == 0);
  CHECK(keys[1].code == 0x7FFFFFFFFFFFFFFF);
  CHECK(keys[2].code == 4);
  CHECK(keys[3].code == 1);
  const PrimitiveRefs huge{ref_at(-3e38f, 0, 0, 0), ref_at(3e38f, 0, 0, 1)};
  CHECK(morton_keys(huge)[1].code == morton_code(0x1FFFFF, 0, 0));
  const PrimitiveRefs equal(9, ref_at(1, 2, 3, 0));
  for (const MortonKey& key : morton_keys(equal)) CHECK(key.code == 0);
}

TEST_CASE("keys are sorted by code, then by name, for any number of threads") {
  for (const size_t dense : {0u, 100u, 150000u}) {
    const PrimitiveRefs refs = clustered(200000, dense, 72);
    for (const unsigned threads : {1u, 3u}) {
      const ThreadLimit limit(threads);
      auto keys = morton_keys(refs), expected = keys;
      sort_keys(keys, refs);
      const auto order = [](const MortonKey& key) { return std::tuple(key.code, key.index); };
      std::sort(expected.begin(), expected.end(),
                [&](const MortonKey& a, const MortonKey& b) { return order(a) < order(b); });
      size_t wrong = 0;
      for (size_t i = 0; i < keys.size(); ++i) wrong += order(keys[i]) != order(expected[i]);
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("equal codes go by name, not by the order they came in") {
  PrimitiveRefs refs;
  for (uint32_t i = 0; i < 1000; ++i) refs.push_back(ref_at(i < 500 ? 0.0f : 1.0f, 0, 0, 999 - i));
  auto keys = morton_keys(refs);
  sort_keys(keys, refs);
  for (size_t i = 0; i < keys.size(); ++i) REQUIRE(refs[keys[i].index].primitive == (i + 500) % 1000);
}
