#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/encode.h>
#include <rayloom/accel/procedural_input.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/accel/triangle_leaf.h>
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

/// How leaves of triangles are written, and before that, how large they are.
struct TriangleLeafWriter {
  std::span<const TriangleGeometry> geometries;
  LeafForm form;
  static constexpr uint64_t overread = TriangleLeaf::overread_bytes;

  LeafContents contents(std::span<const PrimitiveRef> refs) const { return leaf_contents(geometries, refs, form); }
  uint64_t bytes(std::span<const PrimitiveRef> refs) const {
    if (form == LeafForm::full || (form == LeafForm::plain && geometries.size() > 1)) return sizeof(PlainTriangleLeaf);
    return form == LeafForm::plain ? TriangleLeaf::bytes(TriangleLeaf::plain_slots, false) : contents(refs).bytes();
  }
  void write(std::span<const PrimitiveRef> refs, std::byte* address) const { contents(refs).write(address); }
};

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

struct ProceduralLeafWriter {
  std::span<const AabbGeometry> geometries;
  static constexpr uint64_t overread = 0;

  uint64_t bytes(std::span<const PrimitiveRef>) const { return sizeof(ProceduralLeaf8); }
  void write(std::span<const PrimitiveRef> refs, std::byte* address) const { write_boxes(geometries, refs, address); }
};

/// The fastest builder has no time to look for equal vertices.
TriangleLeafWriter writer_for(std::span<const TriangleGeometry> geometries, const TreeInput& input) {
  if (input.build_flags & build_flag::allow_update) return {geometries, LeafForm::full};
  return {geometries, input.builder == Builder::lbvh ? LeafForm::plain : LeafForm::table};
}
ProceduralLeafWriter writer_for(std::span<const AabbGeometry> geometries, const TreeInput&) { return {geometries}; }

std::span<const TriangleGeometry> to_clip(std::span<const TriangleGeometry> geometries) { return geometries; }
std::span<const TriangleGeometry> to_clip(std::span<const AabbGeometry>) { return {}; }

template <class Geometry>
uint64_t build(std::span<const Geometry> geometries, PrimitiveRefs refs, const BuildSettings& settings,
               StructureHeader header, std::byte* block) {
  if (const size_t active = refs.size(); active > 0) {
    TreeInput input = tree_input(header.kind, header.primitive_count, settings);
    input.triangles = to_clip(geometries);
    const BuiltTree built = build_tree(std::move(refs), input);
    const auto leaves = writer_for(geometries, input);
    const LeafBytes leaf_bytes = measure_leaves(built.tree, [&](const BinaryNode& leaf) {
      return leaves.bytes(std::span(built.refs).subspan(leaf.first, leaf.count));
    });
    WideTree wide = make_wide_tree(built.tree, sizeof(StructureHeader), leaf_bytes);
    wide.bytes += leaves.overread;
    write_tree(built.tree, wide, built.refs, block,
               [&](std::span<const PrimitiveRef> range, std::byte* address) { leaves.write(range, address); });
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
