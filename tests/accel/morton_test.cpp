#include <rayloom/accel/binned_sah.h>
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

MortonCurve curve_of(std::span<const PrimitiveRef> refs) { return MortonCurve(bounds_of(refs).centres); }

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
  const MortonCurve curve = curve_of(refs);
  CHECK(curve.code(refs[0]) == 0);
  CHECK(curve.code(refs[1]) == 0x7FFFFFFFFFFFFFFF);
  CHECK(curve.code(refs[2]) == 4);
  CHECK(curve.code(refs[3]) == 1);
  const PrimitiveRefs huge{ref_at(-3e38f, 0, 0, 0), ref_at(3e38f, 0, 0, 1)};
  CHECK(curve_of(huge).code(huge[1]) == morton_code(0x1FFFFF, 0, 0));
  const PrimitiveRefs equal(9, ref_at(1, 2, 3, 0));
  for (const PrimitiveRef& ref : equal) CHECK(curve_of(equal).code(ref) == 0);
}

TEST_CASE("the upper code is the code's upper 32 bits") {
  const PrimitiveRefs refs = clustered(5000, 2000, 73);
  const MortonCurve curve = curve_of(refs);
  for (const PrimitiveRef& ref : refs) REQUIRE(curve.upper_code(ref) == curve.code(ref) >> 31);
}

TEST_CASE("keys are sorted by code, then by name, for any number of threads") {
  for (const size_t dense : {0u, 100u, 150000u}) {
    const PrimitiveRefs refs = clustered(200000, dense, 72);
    for (const unsigned threads : {1u, 3u}) {
      const ThreadLimit limit(threads);
      const MortonCurve curve = curve_of(refs);
      const auto keys = sorted_keys(curve, refs);
      auto expected = keys;
      const auto order = [&](const MortonKey& key) { return std::tuple(curve.code(refs[key.index]), key.index); };
      std::sort(expected.begin(), expected.end(),
                [&](const MortonKey& a, const MortonKey& b) { return order(a) < order(b); });
      for (const MortonKey& key : keys) REQUIRE(key.code == curve.upper_code(refs[key.index]));
      size_t wrong = 0;
      for (size_t i = 0; i < keys.size(); ++i) wrong += order(keys[i]) != order(expected[i]);
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("equal codes go by name, not by the order they came in") {
  PrimitiveRefs refs;
  for (uint32_t i = 0; i < 1000; ++i) refs.push_back(ref_at(i < 500 ? 0.0f : 1.0f, 0, 0, 999 - i));
  const auto keys = sorted_keys(curve_of(refs), refs);
  for (size_t i = 0; i < keys.size(); ++i) REQUIRE(refs[keys[i].index].primitive == (i + 500) % 1000);
}
