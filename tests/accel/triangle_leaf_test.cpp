#include <rayloom/accel/ray.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/accel/triangle_leaf.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <vector>

using namespace rayloom::accel;

namespace {

struct Soup {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;

  TriangleGeometry geometry() const {
    TriangleGeometry out;
    out.vertices = reinterpret_cast<const std::byte*>(vertices.data());
    out.vertex_count = static_cast<uint32_t>(vertices.size() / 3);
    out.indices = reinterpret_cast<const std::byte*>(indices.data());
    out.index_format = IndexFormat::uint32;
    out.triangle_count = static_cast<uint32_t>(indices.size() / 3);
    return out;
  }
};

/// A strip of `count` triangles.
Soup strip(uint32_t count) {
  Soup soup;
  for (uint32_t i = 0; i < count + 2; ++i)
    soup.vertices.insert(soup.vertices.end(), {0.5f * static_cast<float>(i), static_cast<float>(i % 2), 0.25f});
  for (uint32_t i = 0; i < count; ++i) soup.indices.insert(soup.indices.end(), {i, i + 1, i + 2});
  return soup;
}

/// `count` triangles that share nothing.
Soup scattered(uint32_t count) {
  Soup soup;
  for (uint32_t i = 0; i < 3 * count; ++i) {
    soup.vertices.insert(soup.vertices.end(), {static_cast<float>(i), static_cast<float>(i * i % 7), 1});
    soup.indices.push_back(i);
  }
  return soup;
}

std::vector<PrimitiveRef> refs_of(std::span<const TriangleGeometry> geometries) {
  std::vector<PrimitiveRef> refs;
  for (const PrimitiveRef& ref : triangle_refs(geometries, false)) refs.push_back(ref);
  return refs;
}

/// Memory for any leaf.
struct LeafMemory {
  alignas(32) std::byte bytes[sizeof(PlainTriangleLeaf)];
  const TriangleLeaf& leaf() const { return *reinterpret_cast<const TriangleLeaf*>(bytes); }
};

uint32_t slots_of(std::span<const TriangleGeometry> geometries) {
  LeafMemory memory;
  TriangleLeafWriter{geometries}.write(refs_of(geometries), memory.bytes);
  return memory.leaf().slots;
}

/// Writes the leaf and reads every corner back.
void check_round_trip(std::span<const TriangleGeometry> geometries, LeafForm form, uint64_t expected_bytes) {
  const std::vector<PrimitiveRef> refs = refs_of(geometries);
  LeafMemory memory;
  REQUIRE(TriangleLeafWriter{geometries, form}.write(refs, memory.bytes) == expected_bytes);
  const TriangleLeaf& leaf = memory.leaf();
  REQUIRE(leaf.bytes() == expected_bytes);
  REQUIRE(leaf.count == refs.size());
  for (uint32_t lane = 0; lane < leaf.count; ++lane) {
    CHECK(leaf.primitive[lane] == refs[lane].primitive);
    CHECK((leaf.geometry_of(lane) & 0xFFFFFF) == refs[lane].geometry);
    CHECK(leaf.geometry_of(lane) >> 24 == geometries[refs[lane].geometry].flags);
    const InputTriangle triangle = read_triangle(geometries[refs[lane].geometry], refs[lane].primitive);
    for (uint32_t vertex = 0; vertex < 3; ++vertex)
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const float found = leaf.coordinate(vertex, axis, lane), given = triangle.vertex[vertex][axis];
        CHECK(std::memcmp(&found, &given, sizeof(found)) == 0);
      }
  }
}

}  // namespace

TEST_CASE("a leaf keeps each vertex once, and each triangle as it was given") {
  const Soup soup = strip(8);
  const TriangleGeometry geometry[] = {soup.geometry()};
  CHECK(slots_of(geometry) == 10);
  check_round_trip(geometry, LeafForm::table, 192);
  check_round_trip(geometry, LeafForm::full, 384);
}

TEST_CASE("equal vertices are found without indices, but zeros keep their signs") {
  Soup soup = strip(2);
  soup.vertices[0] = 0.0f;
  TriangleGeometry copies[] = {soup.geometry(), soup.geometry()};
  CHECK(slots_of(copies) == 4);
  Soup negative = soup;
  negative.vertices[0] = -0.0f;
  copies[1] = negative.geometry();
  CHECK(slots_of(copies) == 5);
  check_round_trip(copies, LeafForm::table, TriangleLeaf::bytes(5, true));
}

TEST_CASE("told apart by index, equal vertices of two indices are kept twice") {
  Soup soup = strip(2);
  const TriangleGeometry strip_geometry[] = {soup.geometry()};
  check_round_trip(strip_geometry, LeafForm::index_table, TriangleLeaf::bytes(4, false));
  soup.vertices.insert(soup.vertices.end(), soup.vertices.begin(), soup.vertices.begin() + 3);
  soup.indices.insert(soup.indices.end(), {4, 1, 3});  // vertex 4 lies where 0 does
  const TriangleGeometry geometry[] = {soup.geometry()};
  check_round_trip(geometry, LeafForm::index_table, TriangleLeaf::bytes(5, false));
  check_round_trip(geometry, LeafForm::table, TriangleLeaf::bytes(4, false));
}

TEST_CASE("where indices do not help, the table is by position all the same") {
  const Soup soup = strip(2);
  const TriangleGeometry copies[] = {soup.geometry(), soup.geometry()};
  check_round_trip(copies, LeafForm::index_table, TriangleLeaf::bytes(4, true));
  Soup corners;
  for (const uint32_t index : soup.indices)
    corners.vertices.insert(corners.vertices.end(), &soup.vertices[3 * index], &soup.vertices[3 * index] + 3);
  TriangleGeometry list[] = {corners.geometry()};
  list[0].index_format = IndexFormat::none;
  list[0].indices = nullptr;
  list[0].triangle_count = 2;
  check_round_trip(list, LeafForm::index_table, TriangleLeaf::bytes(4, false));
  const Soup many = scattered(8);
  const TriangleGeometry plain[] = {many.geometry()};
  check_round_trip(plain, LeafForm::index_table, 352);
}

TEST_CASE("triangles with more vertices than a table holds make a plain leaf") {
  for (const uint32_t count : {5u, 6u, 8u}) {
    const Soup soup = scattered(count);
    const TriangleGeometry geometry[] = {soup.geometry()};
    check_round_trip(geometry, LeafForm::table, count == 5 ? TriangleLeaf::bytes(15, false) : 352);
  }
}

TEST_CASE("what a plain leaf does not use is zero, whatever the memory held") {
  const Soup soup = scattered(6);
  const TriangleGeometry geometry[] = {soup.geometry()};
  LeafMemory memory;
  std::memset(memory.bytes, 0xAA, sizeof(memory.bytes));
  TriangleLeafWriter{geometry}.write(refs_of(geometry), memory.bytes);
  REQUIRE(memory.leaf().slots == TriangleLeaf::plain_slots);
  for (uint32_t vertex = 0; vertex < 3; ++vertex)
    for (uint32_t axis = 0; axis < 3; ++axis)
      for (uint32_t lane = 6; lane < 8; ++lane) CHECK(memory.leaf().coordinate(vertex, axis, lane) == 0);
}

TEST_CASE("a leaf of several geometries names each lane's") {
  const Soup first = strip(3), second = strip(4);
  TriangleGeometry geometries[] = {first.geometry(), second.geometry()};
  geometries[1].flags = geometry_flag::opaque;
  check_round_trip(geometries, LeafForm::table, TriangleLeaf::bytes(6, true));
  check_round_trip(geometries, LeafForm::full, 384);
}
