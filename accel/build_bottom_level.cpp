#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/encode.h>
#include <rayloom/accel/procedural_input.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/float_environment.h>

#include <cstring>

namespace rayloom::accel {
namespace {

template <class Geometry>
StructureHeader header_for(StructureKind kind, const BuildSettings& settings, std::span<const Geometry> geometries) {
  StructureHeader header = empty_header(kind, settings);
  header.primitive_count = checked_count(geometries);
  header.geometry_count = static_cast<uint32_t>(geometries.size());
  for (const Geometry& geometry : geometries) header.non_opaque_count += !(geometry.flags & geometry_flag::opaque);
  return header;
}

/// Layout's geometry word: index in the low 24 bits, flags above.
template <class Geometry>
uint32_t geometry_word(std::span<const Geometry> geometries, uint32_t geometry) {
  return geometry | (geometries[geometry].flags & 0x7F) << 24;
}

template <class Leaf>
void name_lanes(Leaf& leaf) {
  for (uint32_t lane = 0; lane < leaf_width; ++lane) leaf.primitive[lane] = leaf.geometry[lane] = no_index;
}

bool is_split(const PrimitiveRef& ref, const InputTriangle& corners) {
  Box box;
  for (const auto& vertex : corners.vertex) box.extend(vertex);
  return !std::equal(box.min, box.min + 3, ref.min) || !std::equal(box.max, box.max + 3, ref.max);
}

void write_leaf(std::span<const TriangleGeometry> geometries, std::span<const PrimitiveRef> refs, std::byte* address) {
  TriangleLeaf8 leaf;
  std::fill_n(&leaf.vertex[0][0][0], 9 * leaf_width, std::numeric_limits<float>::quiet_NaN());
  name_lanes(leaf);
  for (size_t lane = 0; lane < refs.size(); ++lane) {
    const PrimitiveRef& ref = refs[lane];
    const InputTriangle corners = read_triangle(geometries[ref.geometry], ref.primitive);
    for (int vertex = 0; vertex < 3; ++vertex)
      for (int axis = 0; axis < 3; ++axis) leaf.vertex[vertex][axis][lane] = corners.vertex[vertex][axis];
    leaf.primitive[lane] = ref.primitive;
    leaf.geometry[lane] = geometry_word(geometries, ref.geometry);
    if (is_split(ref, corners)) leaf.geometry[lane] |= geometry_flag::split << 24;
  }
  std::memcpy(address, &leaf, sizeof(leaf));
}

void write_leaf(std::span<const AabbGeometry> geometries, std::span<const PrimitiveRef> refs, std::byte* address) {
  ProceduralLeaf8 leaf;
  for (auto& axis : leaf.bounds) {
    std::fill_n(axis[0], leaf_width, Box::infinity);
    std::fill_n(axis[1], leaf_width, -Box::infinity);
  }
  name_lanes(leaf);
  for (size_t lane = 0; lane < refs.size(); ++lane) {
    const PrimitiveRef& ref = refs[lane];
    for (int axis = 0; axis < 3; ++axis) {
      leaf.bounds[axis][0][lane] = ref.min[axis];
      leaf.bounds[axis][1][lane] = ref.max[axis];
    }
    leaf.primitive[lane] = ref.primitive;
    leaf.geometry[lane] = geometry_word(geometries, ref.geometry);
  }
  std::memcpy(address, &leaf, sizeof(leaf));
}

std::span<const TriangleGeometry> to_clip(std::span<const TriangleGeometry> geometries) { return geometries; }
std::span<const TriangleGeometry> to_clip(std::span<const AabbGeometry>) { return {}; }

template <class Geometry>
uint64_t build(std::span<const Geometry> geometries, PrimitiveRefs refs, const BuildSettings& settings,
               StructureHeader header, std::byte* block) {
  if (const size_t active = refs.size(); active > 0) {
    TreeInput input = tree_input(header.kind, header.primitive_count, settings);
    input.triangles = to_clip(geometries);
    const BuiltTree built = build_tree(std::move(refs), input);
    const WideTree wide = make_wide_tree(built.tree, sizeof(StructureHeader), leaf_bytes(header.kind));
    write_tree(built.tree, wide, built.refs, block, [&](std::span<const PrimitiveRef> range, std::byte* address) {
      write_leaf(geometries, range, address);
    });
    describe_tree(built.tree, wide, active, header);
  }
  std::memcpy(block, &header, sizeof(header));
  return header.bytes;
}

}  // namespace

uint64_t build_bottom_level(std::span<const TriangleGeometry> geometries, const BuildSettings& settings,
                            std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_result(result, bottom_level_sizes(geometries, settings).result_bytes);
  check_geometries(geometries);
  return build(geometries, triangle_refs(geometries, settings.flags & build_flag::allow_update), settings,
               header_for(StructureKind::triangles, settings, geometries), result.data());
}

uint64_t build_bottom_level(std::span<const AabbGeometry> geometries, const BuildSettings& settings,
                            std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_result(result, bottom_level_sizes(geometries, settings).result_bytes);
  check_geometries(geometries);
  return build(geometries, procedural_refs(geometries), settings,
               header_for(StructureKind::procedurals, settings, geometries), result.data());
}

}  // namespace rayloom::accel
