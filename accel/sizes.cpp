#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/lazy_build.h>
#include <rayloom/accel/lazy_layout.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>

#include <algorithm>

namespace rayloom::accel {

uint32_t leaf_size(StructureKind kind) { return kind == StructureKind::instances ? 1 : leaf_width; }

uint64_t leaf_bytes(StructureKind kind) {
  if (kind == StructureKind::instances) return sizeof(InstanceRecord);
  return kind == StructureKind::triangles ? sizeof(PlainTriangleLeaf) : sizeof(ProceduralLeaf8);
}

uint64_t leaf_budget(uint64_t primitives, StructureKind kind, const BuildSettings& settings) {
  if (kind == StructureKind::instances && may_rebraid(settings)) return rebraid_bound(primitives);
  const bool splits = chosen_builder(kind, settings) == Builder::spatial_splits;
  const uint64_t references = splits ? split_reference_bound(primitives) : primitives;
  const uint64_t full = blocks_for(primitives, leaf_size(kind));
  const uint64_t slack = (settings.flags & build_flag::minimize_memory) ? full / 8 : full / 2 + 6;
  return std::min(references, blocks_for(references, leaf_size(kind)) + slack);
}

uint64_t largest_structure(uint64_t primitives, StructureKind kind, const BuildSettings& settings) {
  const uint64_t leaves = leaf_budget(primitives, kind, settings);
  const uint64_t bytes = sizeof(StructureHeader) + node_bound(leaves) * sizeof(Node8) + leaves * leaf_bytes(kind) +
                         TriangleLeaf::overread_bytes;
  return (bytes + structure_alignment - 1) / structure_alignment * structure_alignment;
}

BuildSizes bottom_level_sizes(std::span<const TriangleGeometry> geometries, const BuildSettings& settings) {
  if (builds_lazily(settings)) return {lazy_layout(geometries, settings).bytes, 0};
  return {largest_structure(checked_count(geometries), StructureKind::triangles, settings), 0};
}

BuildSizes bottom_level_sizes(std::span<const AabbGeometry> geometries, const BuildSettings& settings) {
  return {largest_structure(checked_count(geometries), StructureKind::procedurals, settings), 0};
}

BuildSizes top_level_sizes(uint64_t instance_count, const BuildSettings& settings) {
  check_instance_count(instance_count);
  return {largest_structure(instance_count, StructureKind::instances, settings), 0};
}

}  // namespace rayloom::accel
