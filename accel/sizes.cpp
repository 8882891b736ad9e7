#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/sizes.h>

#include <algorithm>

namespace rayloom::accel {

uint64_t leaf_budget(uint64_t primitives, uint32_t leaf_size, uint32_t build_flags) {
  const uint64_t full = blocks_for(primitives, leaf_size);
  const uint64_t slack = (build_flags & build_flag::minimize_memory) ? full / 8 : full / 2 + 6;
  return std::min(primitives, full + slack);
}

uint64_t largest_structure(uint64_t primitives, uint32_t leaf_size, uint64_t leaf_bytes, uint32_t build_flags) {
  const uint64_t leaves = leaf_budget(primitives, leaf_size, build_flags);
  const uint64_t bytes = sizeof(StructureHeader) + node_bound(leaves) * sizeof(Node8) + leaves * leaf_bytes;
  return (bytes + structure_alignment - 1) / structure_alignment * structure_alignment;
}

BuildSizes bottom_level_sizes(std::span<const TriangleGeometry> geometries, uint32_t build_flags) {
  return {largest_structure(checked_count(geometries), leaf_width, sizeof(TriangleLeaf8), build_flags), 0};
}

BuildSizes bottom_level_sizes(std::span<const AabbGeometry> geometries, uint32_t build_flags) {
  return {largest_structure(checked_count(geometries), leaf_width, sizeof(ProceduralLeaf8), build_flags), 0};
}

BuildSizes top_level_sizes(uint64_t instance_count, uint32_t build_flags) {
  check_instance_count(instance_count);
  return {largest_structure(instance_count, 1, sizeof(InstanceRecord), build_flags), 0};
}

}  // namespace rayloom::accel
