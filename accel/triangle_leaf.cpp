#include <rayloom/accel/ray.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/accel/triangle_leaf.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace rayloom::accel {
namespace {

constexpr uint32_t table_slots = TriangleLeaf::table_slots, plain_slots = TriangleLeaf::plain_slots;

/// Equal bits, so that a vertex keeps the sign of its zeros.
bool same_bits(const float (&a)[3], const float (&b)[3]) {
  return std::bit_cast<uint32_t>(a[0]) == std::bit_cast<uint32_t>(b[0]) &&
         std::bit_cast<uint32_t>(a[1]) == std::bit_cast<uint32_t>(b[1]) &&
         std::bit_cast<uint32_t>(a[2]) == std::bit_cast<uint32_t>(b[2]);
}

/// The table's entry for a vertex, a new one if needed; false if the table is full.
bool enter_vertex(LeafContents& leaf, const float (&vertex)[3], uint8_t& entry) {
  uint32_t i = 0;
  while (i < leaf.slots && !same_bits(leaf.position[i], vertex)) ++i;
  if (i == table_slots) return false;
  if (i == leaf.slots) std::copy_n(vertex, 3, leaf.position[leaf.slots++]);
  entry = static_cast<uint8_t>(i);
  return true;
}

bool fill_table(LeafContents& leaf, std::span<const InputTriangle> triangles) {
  for (size_t lane = 0; lane < triangles.size(); ++lane)
    for (int vertex = 0; vertex < 3; ++vertex)
      if (!enter_vertex(leaf, triangles[lane].vertex[vertex], leaf.corner[vertex][lane])) return false;
  return true;
}

void fill_plain(LeafContents& leaf, std::span<const InputTriangle> triangles) {
  leaf.slots = plain_slots;
  for (size_t vertex = 0; vertex < 3; ++vertex) {
    for (size_t lane = 0; lane < leaf_lanes; ++lane) {
      const size_t entry = leaf_lanes * vertex + lane;
      leaf.corner[vertex][lane] = static_cast<uint8_t>(entry);
      if (lane < triangles.size()) std::copy_n(triangles[lane].vertex[vertex], 3, leaf.position[entry]);
    }
  }
}

bool is_split(const PrimitiveRef& ref, const InputTriangle& corners) {
  Box box;
  for (const auto& vertex : corners.vertex) box.extend(vertex);
  return !std::equal(box.min, box.min + 3, ref.min) || !std::equal(box.max, box.max + 3, ref.max);
}

}  // namespace

LeafContents leaf_contents(std::span<const TriangleGeometry> geometries, std::span<const PrimitiveRef> refs,
                           LeafForm form) {
  LeafContents leaf;
  leaf.count = static_cast<uint32_t>(refs.size());
  leaf.mixed = form == LeafForm::full || (form == LeafForm::plain && geometries.size() > 1);
  InputTriangle triangles[leaf_lanes];
  uint32_t split = 0;
  std::fill_n(leaf.primitive, leaf_lanes, no_index);
  for (size_t lane = 0; lane < refs.size(); ++lane) {
    const uint32_t index = refs[lane].geometry;
    triangles[lane] = read_triangle(geometries[index], refs[lane].primitive);
    if (is_split(refs[lane], triangles[lane])) split = geometry_flag::split;
    leaf.primitive[lane] = refs[lane].primitive;
    leaf.geometry[lane] = index | (geometries[index].flags & 0x7F) << 24;
    leaf.mixed |= leaf.geometry[lane] != leaf.geometry[0];
  }
  for (uint32_t& word : leaf.geometry) word |= split << 24;  // of the leaf, so that one word can serve all lanes
  const std::span<const InputTriangle> used(triangles, refs.size());
  if (form != LeafForm::table || !fill_table(leaf, used)) fill_plain(leaf, used);
  return leaf;
}

void LeafContents::write(std::byte* address) const {
  std::memset(address, 0, bytes());
  auto& leaf = *reinterpret_cast<TriangleLeaf*>(address);
  std::memcpy(leaf.corner, corner, sizeof(corner));
  std::memcpy(leaf.primitive, primitive, sizeof(primitive));
  leaf.geometry = geometry[0];
  leaf.count = static_cast<uint8_t>(count);
  leaf.slots = static_cast<uint8_t>(slots);
  leaf.mixed = mixed;
  for (uint32_t axis = 0; axis < 3; ++axis)
    for (uint32_t i = 0; i < slots; ++i) leaf.row(axis)[i] = position[i][axis];
  if (mixed) std::memcpy(leaf.row(3), geometry, sizeof(geometry));
}

}  // namespace rayloom::accel
