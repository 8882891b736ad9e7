#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/collect_refs.h>
#include <rayloom/accel/encode.h>
#include <rayloom/accel/instance_leaf.h>
#include <rayloom/accel/rebraid.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/base/float_environment.h>

#include <cstring>

namespace rayloom::accel {
namespace {

std::optional<PrimitiveRef> instance_ref(const InstanceDesc& desc, AddressSpace addresses, uint32_t index,
                                         const BuildSettings& settings) {
  const auto box = instance_box(desc, addresses, index, settings);
  const bool keep_hidden = settings.flags & build_flag::allow_update;
  if (!box || (!keep_hidden && is_hidden(desc, addresses))) return std::nullopt;
  return make_primitive_ref(*box, 0, index);
}

struct PadScale {
  double largest = 0;
  void merge(const PadScale& other) { largest = std::max(largest, other.largest); }
};

PadScale pad_scale(std::span<const InstanceDesc> instances, std::span<const PrimitiveRef> refs) {
  return reduce_chunks<PadScale>(refs.size(), [&](size_t begin, size_t end) {
    PadScale scale;
    for (const PrimitiveRef& ref : refs.subspan(begin, end - begin)) {
      const double value = conditioning(instances[ref.primitive]);
      if (value <= max_conditioning) scale.largest = std::max(scale.largest, value);
    }
    return scale;
  });
}

/// Gives the leaves of badly conditioned instances, and all above them, boxes that every ray meets. Children come after
/// their parents in the tree's slots.
void open_ill_conditioned(std::span<const InstanceDesc> instances, std::span<const PrimitiveRef> refs,
                          BinaryTree& tree) {
  constexpr float largest = std::numeric_limits<float>::max();
  for (size_t slot = tree.size(); slot-- > 0;) {
    BinaryNode& node = tree[slot];
    if (node.count == 0) continue;
    if (!node.is_leaf()) {
      node.box.extend(tree[slot + 1].box);
      node.box.extend(tree[node.right].box);
    } else if (conditioning(instances[refs[node.first].primitive]) > max_conditioning) {
      node.box.extend({-largest, -largest, -largest}, {largest, largest, largest});
    }
  }
}

PrimitiveRefs instance_refs(std::span<const InstanceDesc> instances, AddressSpace addresses,
                            const BuildSettings& settings) {
  PrimitiveRefs refs;
  append_refs(refs, instances.size(), [&](uint32_t i) { return instance_ref(instances[i], addresses, i, settings); });
  return refs;
}

StructureHeader top_level_header(std::span<const InstanceDesc> instances, const BuildSettings& settings) {
  StructureHeader header = empty_header(StructureKind::instances, settings);
  header.primitive_count = instances.size();
  for (const InstanceDesc& desc : instances)
    header.non_opaque_count += (desc.flags & instance_flag::force_non_opaque) != 0;
  return header;
}

}  // namespace

uint64_t build_top_level(std::span<const InstanceDesc> instances, AddressSpace addresses, const BuildSettings& settings,
                         std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_result(result, top_level_sizes(instances.size(), settings).result_bytes);
  StructureHeader header = top_level_header(instances, settings);
  PrimitiveRefs refs = instance_refs(instances, addresses, settings);
  if (const size_t active = refs.size(); active > 0) {
    if (may_rebraid(settings)) refs = rebraid(std::move(refs), instances, addresses, rebraid_bound(instances.size()));
    BuiltTree built = build_tree(std::move(refs), tree_input(header.kind, instances.size(), settings));
    const WideTree wide = make_wide_tree(built.tree, sizeof(StructureHeader),
                                         LeafBytes(built.tree.size(), sizeof(InstanceRecord) / granule_bytes));
    describe_tree(built.tree, wide, active, header);
    header.pad_scale = pad_scale_for(pad_scale(instances, built.refs).largest);
    open_ill_conditioned(instances, built.refs, built.tree);
    write_tree(built.tree, wide, built.refs, result.data(),
               [&](std::span<const PrimitiveRef> leaf, std::byte* address) {
                 const PrimitiveRef& ref = leaf[0];
                 write_instance(instances[ref.primitive], ref.primitive, ref.geometry, address);
               });
    note_lazy_instances(instances, addresses, header);
  }
  std::memcpy(result.data(), &header, sizeof(header));
  return header.bytes;
}

}  // namespace rayloom::accel
