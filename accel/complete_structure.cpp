#include <rayloom/accel/build.h>
#include <rayloom/accel/lazy_input.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/structure.h>
#include <rayloom/accel/structure_in_parts.h>
#include <rayloom/base/float_environment.h>

#include <cassert>
#include <cstring>
#include <utility>

namespace rayloom::accel {
namespace {

/// Built elsewhere and then put over the lazy one: parts that rays came to stand in the order in which they came.
void complete_bottom_level(std::byte* block) {
  StructureHeader header = header_of(block);
  const LazyInput input(block);
  header.lazy_root = header.first_part = header.part_count = header.node_count = header.leaf_count = 0;
  const uint64_t most = largest_structure(header.primitive_count, header.kind, header.build_flags);
  assert(most <= header.bytes);
  ScratchVector<std::byte> built(most + granule_bytes);
  void* aligned = built.data();
  size_t space = built.size();
  auto* const place = static_cast<std::byte*>(std::align(granule_bytes, most, aligned, space));
  build_in_parts(input.order(), input.tree_input(), header, {place, most});
  std::memcpy(place, &header, sizeof(header));
  std::memcpy(block, place, header.bytes);
}

void complete_instances(std::byte* block, AddressSpace addresses, uint32_t ref) {
  if (!node_ref::is_leaf(ref)) {
    for (const uint32_t child : reinterpret_cast<const Node8*>(block + node_ref::offset(ref))->child)
      if (child != 0) complete_instances(block, addresses, child);
    return;
  }
  const auto& instance = *reinterpret_cast<const InstanceRecord*>(block + node_ref::offset(ref));
  complete_structure(const_cast<std::byte*>(addresses.host(instance.bottom_level_address)));
}

}  // namespace

void complete_structure(std::byte* block, AddressSpace addresses) {
  const FloatEnvironment environment;
  auto& header = *reinterpret_cast<StructureHeader*>(block);
  if (!is_lazy(header)) return;
  if (header.kind != StructureKind::instances) return complete_bottom_level(block);
  complete_instances(block, addresses, header.lazy_root);
  header.root = std::exchange(header.lazy_root, 0);
}

}  // namespace rayloom::accel
