#include <rayloom/accel/build.h>
#include <rayloom/accel/checks.h>
#include <rayloom/accel/collect_refs.h>
#include <rayloom/accel/encode.h>
#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/structure.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/base/error.h>
#include <rayloom/base/float_environment.h>

#include <cmath>
#include <cstring>
#include <string>

namespace rayloom::accel {
namespace {

/// Instances conditioned worse than this would widen every box of the structure too much; they are visited always.
constexpr double max_conditioning = 1024;

const StructureHeader& bottom_level(const InstanceDesc& desc, AddressSpace addresses, uint32_t index) {
  const std::string name = "instances[" + std::to_string(index) + "].bottom_level_address";
  const StructureHeader& header = checked_header(addresses.host(desc.bottom_level_address), name.c_str());
  if (header.kind == StructureKind::instances)
    throw InputError("acceleration structure", name, "is a top-level structure");
  return header;
}

/// Where the instance lies in the world; a point at its origin when nothing in it is active (PR-14).
Box instance_box(const InstanceDesc& desc, const StructureHeader& header) {
  Box object_box;
  object_box.extend(header.bounds_min, header.bounds_max);
  return world_box(desc.transform, object_box);
}

/// The world box of an instance that a ray may hit. Empty for inactive ones: null address (PR-05), NaN or no inverse in
/// the transform. Those with mask 0 or nothing active inside are kept for updates only.
std::optional<PrimitiveRef> instance_ref(const InstanceDesc& desc, AddressSpace addresses, uint32_t index,
                                         bool keep_hidden) {
  if (desc.bottom_level_address == 0) return std::nullopt;
  const StructureHeader& header = bottom_level(desc, addresses, index);
  const bool hidden = desc.instance_mask == 0 || header.root == no_index;
  if ((hidden && !keep_hidden) || !invert(desc.transform)) return std::nullopt;
  return make_primitive_ref(instance_box(desc, header), 0, index);
}

double conditioning(const InstanceDesc& desc) { return invert(desc.transform)->conditioning; }

struct PadScale {
  double largest = 0;
  void merge(const PadScale& other) { largest = std::max(largest, other.largest); }
  float round_up() const { return std::nextafter(static_cast<float>(1 + largest), Box::infinity); }
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

void write_record(const InstanceDesc& desc, uint32_t index, std::byte* address) {
  InstanceRecord record;
  std::memset(&record, 0, sizeof(record));  // padding too: same input, same bytes
  const InverseTransform inverse = *invert(desc.transform);
  std::memcpy(record.world_to_object, inverse.matrix, sizeof(inverse.matrix));
  std::memcpy(record.object_to_world, desc.transform, sizeof(desc.transform));
  record.bottom_level_address = desc.bottom_level_address;
  record.instance_index = index;
  record.id_and_mask = desc.instance_id | uint32_t{desc.instance_mask} << 24;
  record.contribution_and_flags = desc.instance_contribution_to_hit_group_index | uint32_t{desc.flags} << 24;
  std::memcpy(address, &record, sizeof(record));
}

PrimitiveRefs instance_refs(std::span<const InstanceDesc> instances, AddressSpace addresses, bool keep_hidden) {
  PrimitiveRefs refs;
  append_refs(refs, instances.size(),
              [&](uint32_t i) { return instance_ref(instances[i], addresses, i, keep_hidden); });
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
  PrimitiveRefs refs = instance_refs(instances, addresses, settings.flags & build_flag::allow_update);
  if (const size_t active = refs.size(); active > 0) {
    BuiltTree built = build_tree(std::move(refs), tree_input(header.kind, instances.size(), settings));
    const WideTree wide = make_wide_tree(built.tree, sizeof(StructureHeader), leaf_bytes(header.kind));
    describe_tree(built.tree, wide, active, header);
    header.pad_scale = pad_scale(instances, built.refs).round_up();
    open_ill_conditioned(instances, built.refs, built.tree);
    write_tree(built.tree, wide, built.refs, result.data(),
               [&](std::span<const PrimitiveRef> leaf, std::byte* address) {
                 write_record(instances[leaf[0].primitive], leaf[0].primitive, address);
               });
  }
  std::memcpy(result.data(), &header, sizeof(header));
  return header.bytes;
}

}  // namespace rayloom::accel
