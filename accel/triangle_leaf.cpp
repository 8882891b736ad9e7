#include <rayloom/accel/ray.h>
#include <rayloom/accel/read_triangle.h>
#include <rayloom/accel/triangle_leaf.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace rayloom::accel {
namespace {

constexpr uint32_t table_slots = TriangleLeaf::table_slots, plain_slots = TriangleLeaf::plain_slots;
constexpr uint32_t most_corners = 3 * leaf_lanes;

using Word4 __attribute__((vector_size(16))) = uint32_t;

/// The corners of a leaf's triangles, a triangle's three side by side.
struct Corners {
  alignas(16) float axis[3][most_corners] = {};

  void set(size_t lane, const InputTriangle& triangle) {
    for (size_t vertex = 0; vertex < 3; ++vertex)
      for (size_t k = 0; k < 3; ++k) axis[k][3 * lane + vertex] = triangle.vertex[vertex][k];
  }
  Word4 four(size_t k, size_t group) const {
    Word4 words;
    std::memcpy(&words, axis[k] + 4 * group, sizeof(words));
    return words;
  }
};

/// For each corner the first one of equal bits, so that a vertex keeps the sign of its zeros. All pairs at once, since
/// what a search would branch on cannot be predicted.
void find_first(const Corners& corners, uint32_t count, uint8_t (&first)[most_corners]) {
  for (uint32_t i = 0; i < count; ++i) {
    Word4 found = {}, bits = {1, 2, 4, 8};
    Word4 point[3];
    for (size_t k = 0; k < 3; ++k) point[k] = Word4{} + std::bit_cast<uint32_t>(corners.axis[k][i]);
    for (uint32_t group = 0; group <= i / 4; ++group, bits <<= 4) {
      const auto same = (corners.four(0, group) == point[0]) & (corners.four(1, group) == point[1]) &
                        (corners.four(2, group) == point[2]);
      found |= reinterpret_cast<Word4>(same) & bits;
    }
    first[i] = static_cast<uint8_t>(std::countr_zero(found[0] | found[1] | found[2] | found[3]));
  }
}

/// Rows of the table, with room for as many entries as there are corners.
struct Rows {
  float axis[3][most_corners];
  uint8_t corner[3][leaf_lanes] = {};
  uint32_t slots = 0;
};

void fill_table(Rows& rows, const Corners& corners, uint32_t count) {
  uint8_t first[most_corners], entry[most_corners];
  find_first(corners, count, first);
  for (uint32_t i = 0; i < count; ++i) {
    for (size_t k = 0; k < 3; ++k) rows.axis[k][rows.slots] = corners.axis[k][i];
    entry[i] = static_cast<uint8_t>(rows.slots);
    rows.corner[i % 3][i / 3] = entry[first[i]];
    rows.slots += first[i] == i;
  }
}

void fill_plain(Rows& rows, const Corners& corners) {
  rows.slots = plain_slots;
  for (uint32_t vertex = 0; vertex < 3; ++vertex) {
    for (uint32_t lane = 0; lane < leaf_lanes; ++lane) {
      const uint32_t slot = leaf_lanes * vertex + lane;
      rows.corner[vertex][lane] = static_cast<uint8_t>(slot);
      for (size_t k = 0; k < 3; ++k) rows.axis[k][slot] = corners.axis[k][3 * lane + vertex];
    }
  }
}

bool is_clipped(const PrimitiveRef& ref, const InputTriangle& corners) {
  Box box;
  for (const auto& vertex : corners.vertex) box.extend(vertex);
  return !std::equal(box.min, box.min + 3, ref.min) || !std::equal(box.max, box.max + 3, ref.max);
}

/// Copies of fixed length run into the next row's place; rows are written in order. A table's longest row fits even
/// behind two others of its kind.
void write_rows(const Rows& rows, TriangleLeaf& leaf) {
  constexpr size_t table_row = table_slots * sizeof(float);
  static_assert(sizeof(TriangleLeaf) + 3 * table_row + granule_bytes <= sizeof(PlainTriangleLeaf));
  for (uint32_t k = 0; k < 3; ++k)
    if (rows.slots == plain_slots)
      std::memcpy(leaf.row(k), rows.axis[k], sizeof(rows.axis[k]));
    else
      std::memcpy(leaf.row(k), rows.axis[k], table_row);
}

}  // namespace

uint64_t TriangleLeafWriter::write(std::span<const PrimitiveRef> refs, std::byte* address) const {
  auto& leaf = *reinterpret_cast<TriangleLeaf*>(address);
  const auto count = static_cast<uint32_t>(refs.size());
  Corners corners;
  uint32_t geometry[leaf_lanes] = {};
  uint32_t split = 0;
  bool mixed = form == LeafForm::full;
  std::fill_n(leaf.primitive, leaf_lanes, no_index);
  for (size_t lane = 0; lane < count; ++lane) {
    const uint32_t index = refs[lane].geometry;
    const InputTriangle triangle = read_triangle(geometries[index], refs[lane].primitive);
    corners.set(lane, triangle);
    if (clipped && is_clipped(refs[lane], triangle)) split = geometry_flag::split;
    leaf.primitive[lane] = refs[lane].primitive;
    geometry[lane] = index | (geometries[index].flags & 0x7F) << 24;
    mixed |= geometry[lane] != geometry[0];
  }
  for (uint32_t& word : geometry) word |= split << 24;  // of the leaf, so that one word can serve all lanes
  Rows rows;
  if (form == LeafForm::table) fill_table(rows, corners, 3 * count);
  if (form != LeafForm::table || rows.slots > table_slots) fill_plain(rows, corners);
  std::memcpy(leaf.corner, rows.corner, sizeof(leaf.corner));
  leaf.geometry = geometry[0];
  leaf.count = static_cast<uint8_t>(count);
  leaf.slots = static_cast<uint8_t>(rows.slots);
  leaf.mixed = mixed;
  leaf.reserved = 0;
  write_rows(rows, leaf);
  const uint64_t used = sizeof(TriangleLeaf) + 3 * sizeof(float) * rows.slots, bytes = leaf.bytes();
  std::memset(address + used, 0, bytes - used);
  if (mixed) std::memcpy(leaf.row(3), geometry, sizeof(geometry));
  return bytes;
}

void TriangleLeafWriter::prefetch_indices(std::span<const PrimitiveRef> refs) const {
  for (const PrimitiveRef& ref : refs) {
    const TriangleGeometry& geometry = geometries[ref.geometry];
    const uint64_t stride = geometry.index_format == IndexFormat::uint16 ? 6 : 12;
    if (geometry.index_format != IndexFormat::none) __builtin_prefetch(geometry.indices + stride * ref.primitive);
  }
}

void TriangleLeafWriter::prefetch_vertices(std::span<const PrimitiveRef> refs) const {
  for (const PrimitiveRef& ref : refs) {
    const TriangleGeometry& geometry = geometries[ref.geometry];
    const auto stride = static_cast<uint32_t>(geometry.vertex_stride);
    for (const uint32_t index : read_indices(geometry, ref.primitive))
      __builtin_prefetch(geometry.vertices + uint64_t{index} * stride);
  }
}

}  // namespace rayloom::accel
