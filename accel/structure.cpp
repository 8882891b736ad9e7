#include <rayloom/accel/build.h>
#include <rayloom/accel/lazy_part.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/structure.h>
#include <rayloom/base/error.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

bool is_consistent(const StructureHeader& header) {
  const bool known = header.kind >= StructureKind::triangles && header.kind <= StructureKind::instances;
  const uint32_t root = root_of(header);
  const bool empty = root == no_index;
  const uint64_t root_end = node_ref::offset(root) + sizeof(Node8);
  return known && header.depth <= max_depth && header.bytes >= sizeof(StructureHeader) &&
         (empty ? header.active_count == 0 : !node_ref::is_leaf(root) && root_end <= header.bytes);
}

}  // namespace

const StructureHeader& checked_header(const std::byte* block, const char* object) {
  const auto fail = [&](const char* rule) { throw InputError("acceleration structure", object, rule); };
  if (!block) fail("is null");
  if (reinterpret_cast<uintptr_t>(block) % alignof(StructureHeader) != 0) fail("is not aligned as a structure is");
  const StructureHeader& header = header_of(block);
  if (header.magic != structure_magic) fail("is not an acceleration structure of this version");
  if (!is_consistent(header)) fail("has a damaged header");
  return header;
}

StructureInfo structure_info(const std::byte* block) {
  const StructureHeader& header = checked_header(block, "block");
  StructureInfo info;
  info.top_level = header.kind == StructureKind::instances;
  info.procedural = header.kind == StructureKind::procedurals;
  info.build_flags = header.build_flags;
  info.builder = static_cast<Builder>(header.builder);
  info.bytes = header.bytes;
  info.depth = header.depth;
  info.nodes = header.node_count;
  info.leaves = header.leaf_count;
  info.primitives = header.primitive_count;
  info.active_primitives = header.active_count;
  info.geometries = header.geometry_count;
  info.lazy = is_lazy(header);
  if (info.lazy && !info.top_level) {
    info.parts = header.part_count;
    info.built_parts = built_lazy_parts(block);
  }
  info.sah_cost = header.sah_cost;
  std::copy_n(header.bounds_min, 3, info.bounds_min);
  std::copy_n(header.bounds_max, 3, info.bounds_max);
  return info;
}

}  // namespace rayloom::accel
