#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/lazy_layout.h>
#include <rayloom/accel/sizes.h>

namespace rayloom::accel {
namespace {

constexpr uint64_t round_up(uint64_t bytes, uint64_t to) { return (bytes + to - 1) / to * to; }

uint64_t slack(uint64_t full, const BuildSettings& settings) {
  return (settings.flags & build_flag::minimize_memory) ? full / 8 : full / 2;
}

constexpr uint64_t least_slack = 2;

/// Leaves and nodes of all parts: the sum of what part_leaf_budget() and node_bound() give for each. And a few more:
/// as many at least as largest_structure() has, which takes this place in the end (complete_structure()).
uint64_t built_bytes(uint64_t primitives, const BuildSettings& settings) {
  const uint64_t parts = most_lazy_parts(primitives), full = primitives / leaf_width + parts;
  const uint64_t leaves = full + slack(full, settings) + least_slack * parts + 6, nodes = parts + 3 * leaves / 5;
  return nodes * sizeof(Node8) + leaves * sizeof(PlainTriangleLeaf) + parts * TriangleLeaf::overread_bytes;
}

}  // namespace

uint64_t part_leaf_budget(uint64_t triangles, const BuildSettings& settings) {
  const uint64_t full = blocks_for(triangles, leaf_width);
  return std::min(triangles, full + slack(full, settings) + least_slack);
}

LazyLayout lazy_layout(std::span<const TriangleGeometry> geometries, const BuildSettings& settings) {
  const uint64_t primitives = checked_count(geometries), parts = most_lazy_parts(primitives);
  LazyLayout layout;
  layout.parts = round_up(LazyLayout::roots + parts * sizeof(uint32_t), granule_bytes);
  layout.nodes = layout.parts + parts * sizeof(LazyPart) + TriangleLeaf::overread_bytes;
  layout.built = layout.nodes + node_bound(parts) * sizeof(Node8);
  layout.geometries = round_up(layout.built + built_bytes(primitives, settings), granule_bytes);
  layout.keys = layout.geometries + geometries.size() * sizeof(LazyGeometry);
  layout.buffers = layout.keys + primitives * sizeof(MortonKey);
  layout.bytes = layout.buffers;
  for (const TriangleGeometry& geometry : geometries)
    layout.bytes += copied_vertices(geometry) * 12 + round_up(copied_index_bytes(geometry), 4);
  layout.bytes = round_up(layout.bytes, structure_alignment);
  return layout;
}

}  // namespace rayloom::accel
