#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/encode.h>
#include <rayloom/accel/encoded_leaves.h>
#include <rayloom/accel/lazy_build.h>
#include <rayloom/accel/procedural_input.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/structure_in_parts.h>
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

void write_boxes(std::span<const AabbGeometry> geometries, std::span<const PrimitiveRef> refs, std::byte* address) {
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

/// Lays the tree out and writes its nodes, and its leaves by write_leaf(slot, address).
template <class WriteLeaf>
void write_structure(const BuiltTree& built, const LeafBytes& leaf_bytes, uint64_t overread, StructureHeader& header,
                     std::byte* block, const WriteLeaf& write_leaf) {
  WideTree wide = make_wide_tree(built.tree, sizeof(StructureHeader), leaf_bytes);
  wide.bytes += overread;
  write_nodes(built.tree, wide, block, write_leaf);
  std::memset(block + wide.bytes - overread, 0, overread);
  describe_tree(built.tree, wide, built.refs.size(), header);
}

std::span<const PrimitiveRef> refs_of(const BuiltTree& built, uint32_t slot) {
  return std::span(built.refs).subspan(built.tree[slot].first, built.tree[slot].count);
}

LeafBytes equal_sizes(const BuiltTree& built, uint64_t bytes) {
  return LeafBytes(built.tree.size(), static_cast<uint16_t>(bytes / granule_bytes));
}

void write_leaves_and_nodes(std::span<const TriangleGeometry> geometries, const TreeInput& input,
                            const BuiltTree& built, StructureHeader& header, std::byte* block) {
  const bool updatable = input.build_flags & build_flag::allow_update;
  const TriangleLeafWriter writer{geometries, updatable ? LeafForm::full : LeafForm::table,
                                  input.builder == Builder::spatial_splits};
  const EncodedLeaves leaves(built.tree, built.refs, writer);
  write_structure(built, leaves.sizes(), TriangleLeaf::overread_bytes, header, block,
                  [&](uint32_t slot, std::byte* address) { leaves.write(slot, address); });
}

void write_leaves_and_nodes(std::span<const AabbGeometry> geometries, const TreeInput&, const BuiltTree& built,
                            StructureHeader& header, std::byte* block) {
  write_structure(built, equal_sizes(built, sizeof(ProceduralLeaf8)), 0, header, block,
                  [&](uint32_t slot, std::byte* address) { write_boxes(geometries, refs_of(built, slot), address); });
}

template <class Geometry>
uint64_t build(std::span<const Geometry> geometries, PrimitiveRefs refs, const BuildSettings& settings,
               StructureHeader header, std::byte* block) {
  if (const size_t active = refs.size(); active > 0) {
    TreeInput input = tree_input(header.kind, header.primitive_count, settings);
    input.triangles = to_clip(geometries);
    const BuiltTree built = build_tree(std::move(refs), input);
    write_leaves_and_nodes(geometries, input, built, header, block);
    header.active_count = active;  // references may be more
  }
  std::memcpy(block, &header, sizeof(header));
  return header.bytes;
}

uint64_t build_in_parts(std::span<const TriangleGeometry> geometries, const BuildSettings& settings,
                        std::span<std::byte> result) {
  StructureHeader header = header_for(StructureKind::triangles, settings, geometries);
  if (builds_lazily(settings)) {
    build_lazily(geometries, settings, header, result.data());
    std::memcpy(result.data(), &header, sizeof(header));
    return header.bytes;
  }
  TreeInput input = tree_input(header.kind, header.primitive_count, settings);
  input.triangles = geometries;
  build_in_parts(input, header, result);
  std::memcpy(result.data(), &header, sizeof(header));
  return header.bytes;
}

}  // namespace

uint64_t build_bottom_level(std::span<const TriangleGeometry> geometries, const BuildSettings& settings,
                            std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_result(result, bottom_level_sizes(geometries, settings).result_bytes);
  check_geometries(geometries);
  if (builds_in_parts(chosen_builder(StructureKind::triangles, settings)))
    return build_in_parts(geometries, settings, result);
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
