#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/encode.h>
#include <rayloom/accel/procedural_input.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/float_environment.h>

#include <cstring>

namespace rayloom::accel {
namespace {

template <class Geometry>
StructureHeader header_for(StructureKind kind, uint32_t build_flags, std::span<const Geometry> geometries) {
  StructureHeader header = empty_header(kind, build_flags);
  header.primitive_count = checked_count(geometries);
  header.geometry_count = static_cast<uint32_t>(geometries.size());
  for (const Geometry& geometry : geometries) header.non_opaque_count += !(geometry.flags & geometry_flag::opaque);
  return header;
}

/// Layout's geometry word: index in the low 24 bits, flags above.
template <class Geometry>
uint32_t geometry_word(std::span<const Geometry> geometries, uint32_t geometry) {
  return geometry | (geometries[geometry].flags & 0xFF) << 24;
}

template <class Leaf>
void name_lanes(Leaf& leaf) {
  for (uint32_t lane = 0; lane < leaf_width; ++lane) leaf.primitive[lane] = leaf.geometry[lane] = no_index;
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

template <class Leaf, class Geometry>
uint64_t build(std::span<const Geometry> geometries, std::span<PrimitiveRef> refs, const StructureHeader& input,
               std::byte* block) {
  StructureHeader header = input;
  if (!refs.empty()) {
    const uint64_t budget = leaf_budget(header.primitive_count, leaf_width, header.build_flags);
    const BinaryTree tree = build_binary_tree(refs, {leaf_width, budget});
    const WideTree wide = make_wide_tree(tree, sizeof(StructureHeader), sizeof(Leaf));
    write_tree(tree, wide, refs, block, [&](std::span<const PrimitiveRef> range, std::byte* address) {
      write_leaf(geometries, range, address);
    });
    describe_tree(tree, wide, refs.size(), header);
  }
  std::memcpy(block, &header, sizeof(header));
  return header.bytes;
}

}  // namespace

uint64_t build_bottom_level(std::span<const TriangleGeometry> geometries, uint32_t build_flags,
                            std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_result(result, bottom_level_sizes(geometries, build_flags).result_bytes);
  check_geometries(geometries);
  std::vector<PrimitiveRef> refs = triangle_refs(geometries, build_flags & build_flag::allow_update);
  return build<TriangleLeaf8>(geometries, refs, header_for(StructureKind::triangles, build_flags, geometries),
                              result.data());
}

uint64_t build_bottom_level(std::span<const AabbGeometry> geometries, uint32_t build_flags,
                            std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_result(result, bottom_level_sizes(geometries, build_flags).result_bytes);
  check_geometries(geometries);
  std::vector<PrimitiveRef> refs = procedural_refs(geometries);
  return build<ProceduralLeaf8>(geometries, refs, header_for(StructureKind::procedurals, build_flags, geometries),
                                result.data());
}

}  // namespace rayloom::accel
