#include <rayloom/accel/ray.h>
#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/accel/triangle_leaf.h>
#include <rayloom/accel/triangle_numbers.h>

#include <algorithm>
#include <cstring>

namespace rayloom::accel {
namespace {

constexpr uint32_t table_slots = TriangleLeaf::table_slots, plain_slots = TriangleLeaf::plain_slots;
constexpr uint32_t most_corners = 3 * leaf_lanes;

/// Rows of the table, with room for as many entries as there are corners.
struct Rows {
  float axis[3][most_corners];
  uint8_t corner[3][leaf_lanes] = {};
  uint32_t slots = 0;

  /// Four points from entry `first` on, coordinate by coordinate.
  void set_four(uint32_t first, const Float4* p) {
    const Float4 xy01 = __builtin_shufflevector(p[0], p[1], 0, 4, 1, 5),
                 xy23 = __builtin_shufflevector(p[2], p[3], 0, 4, 1, 5),
                 z01 = __builtin_shufflevector(p[0], p[1], 2, 6, 2, 6),
                 z23 = __builtin_shufflevector(p[2], p[3], 2, 6, 2, 6);
    const Float4 x = __builtin_shufflevector(xy01, xy23, 0, 1, 4, 5),
                 y = __builtin_shufflevector(xy01, xy23, 2, 3, 6, 7), z = __builtin_shufflevector(z01, z23, 0, 1, 4, 5);
    std::memcpy(axis[0] + first, &x, sizeof(x));
    std::memcpy(axis[1] + first, &y, sizeof(y));
    std::memcpy(axis[2] + first, &z, sizeof(z));
  }
};

/// Equal vertices are those of equal bits, so that a vertex keeps the sign of its zeros.
struct SamePoint {
  using Key = detail::Mask4;
  static Key key(Float4 point) {
    Key bits;
    std::memcpy(&bits, &point, sizeof(bits));
    return bits;
  }
  static bool equal(const Key& a, const Key& b) { return detail::all(a == b); }
  static uint32_t hash(const Key& bits) {
    const auto x = static_cast<uint32_t>(bits[0]), y = static_cast<uint32_t>(bits[1]),
               z = static_cast<uint32_t>(bits[2]);
    return x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ z * 0xC2B2AE3Du;
  }
};

/// Equal vertices are those of one index.
struct SameIndex {
  using Key = uint32_t;
  static bool equal(Key a, Key b) { return a == b; }
  static uint32_t hash(Key index) { return index * 0x9E3779B1u; }
};

/// A leaf's vertices in the order of their first use. A small hash table finds a vertex without comparing it with all
/// others, and without branches nobody can predict.
template <class Same>
class VertexTable {
 public:
  using Key = typename Same::Key;

  /// The entry of a vertex.
  uint8_t add(const Key& key) {
    uint32_t place = Same::hash(key) >> (32 - place_bits);
    uint32_t found = entry_[place];
    while ((found != 0) & !Same::equal(key_[found], key)) found = entry_[place = (place + 1) % places];  // rare
    const uint32_t is_new = found == 0;
    const uint32_t entry = found | (size_ & (0 - is_new));
    key_[size_] = key;
    entry_[place] = static_cast<uint8_t>(entry);
    size_ += is_new;
    return static_cast<uint8_t>(entry - 1);
  }

  uint32_t size() const { return size_ - 1; }
  const Key* keys() const { return key_ + 1; }

 private:
  static constexpr uint32_t place_bits = 7, places = 1u << place_bits;

  uint8_t entry_[places] = {};      ///< 0: none
  Key key_[most_corners + 5] = {};  ///< from 1 on
  uint32_t size_ = 1;
};

void fill_table(Rows& rows, const Corners4 (&triangles)[leaf_lanes], uint32_t count) {
  VertexTable<SamePoint> table;
  for (uint32_t lane = 0; lane < count; ++lane)
    for (uint32_t vertex = 0; vertex < 3; ++vertex)
      rows.corner[vertex][lane] = table.add(SamePoint::key(triangles[lane].corner[vertex]));
  rows.slots = table.size();
  for (uint32_t first = 0; first < rows.slots; first += 4)
    rows.set_four(first, reinterpret_cast<const Float4*>(table.keys() + first));
}

void fill_table(Rows& rows, const TriangleGeometry& geometry, std::span<const PrimitiveRef> refs) {
  VertexTable<SameIndex> table;
  for (uint32_t vertex = 0; vertex < 3; ++vertex)
    for (uint32_t lane = 0; lane < refs.size(); ++lane)
      rows.corner[vertex][lane] = table.add(read_indices(geometry, refs[lane].primitive)[vertex]);
  rows.slots = table.size();
  for (uint32_t first = 0; first < rows.slots; first += 4) {
    Float4 points[4] = {};
    for (uint32_t i = 0; i < std::min(4u, rows.slots - first); ++i)
      points[i] = load_vertex(geometry, table.keys()[first + i]);
    rows.set_four(first, points);
  }
}

void fill_plain(Rows& rows, const Corners4 (&triangles)[leaf_lanes], uint32_t count) {
  rows.slots = plain_slots;
  for (uint32_t vertex = 0; vertex < 3; ++vertex) {
    for (uint32_t lane = 0; lane < leaf_lanes; ++lane) {
      const uint32_t slot = leaf_lanes * vertex + lane;
      rows.corner[vertex][lane] = static_cast<uint8_t>(slot);
      for (int k = 0; k < 3; ++k) rows.axis[k][slot] = lane < count ? triangles[lane].corner[vertex][k] : 0;
    }
  }
}

bool is_clipped(const PrimitiveRef& ref, const Corners4& corners) {
  const Box box = corners.box().box();
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

void fill_rows(const TriangleLeafWriter& writer, Rows& rows, std::span<const PrimitiveRef> refs,
               uint32_t (&geometry)[leaf_lanes]) {
  const auto count = static_cast<uint32_t>(refs.size());
  Corners4 triangles[leaf_lanes];
  uint32_t split = 0;
  for (uint32_t lane = 0; lane < count; ++lane) {
    const TriangleGeometry& from = writer.geometries[refs[lane].geometry];
    triangles[lane] = load_corners(from, read_indices(from, refs[lane].primitive));
    if (writer.clipped && is_clipped(refs[lane], triangles[lane])) split = geometry_flag::split;
  }
  for (uint32_t& word : geometry) word |= split << 24;  // of the leaf, so that one word can serve all lanes
  if (writer.form != LeafForm::full) fill_table(rows, triangles, count);
  if (writer.form == LeafForm::full || rows.slots > table_slots) fill_plain(rows, triangles, count);
}

void name_lanes(std::span<const PrimitiveRef> refs, TriangleLeaf& leaf) {
  std::fill_n(leaf.primitive, leaf_lanes, no_index);
  for (size_t lane = 0; lane < refs.size(); ++lane) leaf.primitive[lane] = refs[lane].primitive;
}

void write_table(const Rows& rows, size_t count, TriangleLeaf& leaf) {
  std::memcpy(leaf.corner, rows.corner, sizeof(leaf.corner));
  leaf.count = static_cast<uint8_t>(count);
  leaf.slots = static_cast<uint8_t>(rows.slots);
  leaf.mixed = leaf.reserved = 0;
  write_rows(rows, leaf);
}

/// All of a leaf of one geometry but its geometry word; returns how many entries the table takes, and has written
/// nothing if those are too many.
uint32_t write_by_index(const TriangleGeometry& geometry, std::span<const PrimitiveRef> refs, TriangleLeaf& leaf) {
  if (const BuildKernel* const kernel = build_kernel(); kernel && vectors_read(geometry))
    return kernel->write_table_leaf(geometry, refs, leaf);
  Rows rows;
  fill_table(rows, geometry, refs);
  if (rows.slots > table_slots) return rows.slots;
  name_lanes(refs, leaf);
  write_table(rows, refs.size(), leaf);
  return rows.slots;
}

/// Layout's geometry word: index in the low 24 bits, flags above.
uint32_t geometry_word(std::span<const TriangleGeometry> geometries, uint32_t geometry) {
  return geometry | (geometries[geometry].flags & 0x7F) << 24;
}

bool one_geometry(std::span<const PrimitiveRef> refs) {
  uint32_t different = 0;
  for (const PrimitiveRef& ref : refs) different |= ref.geometry ^ refs[0].geometry;
  return different == 0;
}

/// Leaves of any form, all but what follows the table.
void write_any(const TriangleLeafWriter& writer, std::span<const PrimitiveRef> refs, TriangleLeaf& leaf,
               uint32_t (&geometry)[leaf_lanes]) {
  for (size_t lane = 0; lane < refs.size(); ++lane)
    geometry[lane] = geometry_word(writer.geometries, refs[lane].geometry);
  Rows rows;
  fill_rows(writer, rows, refs, geometry);
  name_lanes(refs, leaf);
  write_table(rows, refs.size(), leaf);
  leaf.geometry = geometry[0];
  leaf.mixed = writer.form == LeafForm::full || !one_geometry(refs);
}

/// Zeroes from after the last word to the granule's end, and perhaps as many behind it where a PlainTriangleLeaf's
/// geometries would be.
void pad(TriangleLeaf& leaf) {
  auto* const table_end = reinterpret_cast<std::byte*>(leaf.row(3));
  if (!leaf.mixed) {
    std::memset(table_end, 0, granule_bytes);
  } else {
    const uint64_t used = 64 + 12 * uint64_t{leaf.slots} + sizeof(uint32_t) * leaf_lanes;
    std::memset(table_end + sizeof(uint32_t) * leaf_lanes, 0, leaf.bytes() - used);
  }
}

}  // namespace

uint64_t TriangleLeafWriter::write(std::span<const PrimitiveRef> refs, std::byte* address) const {
  const TriangleGeometry& first = geometries[refs[0].geometry];
  const bool by_index = form == LeafForm::index_table && first.index_format != IndexFormat::none && one_geometry(refs);
  if (auto& leaf = *reinterpret_cast<TriangleLeaf*>(address);
      by_index && write_by_index(first, refs, leaf) <= table_slots) {
    leaf.geometry = geometry_word(geometries, refs[0].geometry);
    pad(leaf);
    return leaf.bytes();
  }
  return write_by_value(refs, address);
}

uint64_t TriangleLeafWriter::write_by_value(std::span<const PrimitiveRef> refs, std::byte* address) const {
  auto& leaf = *reinterpret_cast<TriangleLeaf*>(address);
  uint32_t geometry[leaf_lanes] = {};
  write_any(*this, refs, leaf, geometry);
  if (leaf.mixed) std::memcpy(leaf.row(3), geometry, sizeof(geometry));
  pad(leaf);
  return leaf.bytes();
}

uint64_t TriangleLeafWriter::write_of_rows(const TriangleRows& rows, size_t first, std::span<PrimitiveRef> refs,
                                           std::byte* address) const {
  auto& leaf = *reinterpret_cast<TriangleLeaf*>(address);
  if (build_kernel()->write_leaf_of_rows(geometries[0], rows, first, refs.size(), leaf) > table_slots) {
    std::sort(refs.begin(), refs.end(), name_less);
    return write_by_value(refs, address);
  }
  leaf.geometry = geometry_word(geometries, 0);
  pad(leaf);
  return leaf.bytes();
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
