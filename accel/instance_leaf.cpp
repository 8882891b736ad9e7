#include <rayloom/accel/close_box.h>
#include <rayloom/accel/instance_leaf.h>
#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/ray.h>
#include <rayloom/accel/structure.h>
#include <rayloom/base/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace rayloom::accel {
namespace {

const StructureHeader& bottom_level(const InstanceDesc& desc, AddressSpace addresses, uint32_t index) {
  const std::string name = "instances[" + std::to_string(index) + "].bottom_level_address";
  const StructureHeader& header = checked_header(addresses.host(desc.bottom_level_address), name.c_str());
  if (header.kind == StructureKind::instances)
    throw InputError("acceleration structure", name, "is a top-level structure");
  return header;
}

}  // namespace

std::optional<Box> instance_box(const InstanceDesc& desc, AddressSpace addresses, uint32_t index,
                                const BuildSettings& settings) {
  if (desc.bottom_level_address == 0) return std::nullopt;
  bottom_level(desc, addresses, index);
  if (!invert(desc.transform)) return std::nullopt;
  return close_world_box(desc.transform, addresses.host(desc.bottom_level_address), box_levels(settings));
}

bool is_hidden(const InstanceDesc& desc, AddressSpace addresses) {
  return desc.instance_mask == 0 || root_of(header_of(addresses.host(desc.bottom_level_address))) == no_index;
}

double conditioning(const InstanceDesc& desc) { return invert(desc.transform)->conditioning; }

float pad_scale_for(double largest) { return std::nextafter(static_cast<float>(1 + largest), Box::infinity); }

void note_lazy_instances(std::span<const InstanceDesc> instances, AddressSpace addresses, StructureHeader& header) {
  const auto lazy = [&](const InstanceDesc& desc) {
    return desc.bottom_level_address != 0 && is_lazy(header_of(addresses.host(desc.bottom_level_address)));
  };
  if (header.root == no_index || std::none_of(instances.begin(), instances.end(), lazy)) return;
  header.lazy_root = std::exchange(header.root, no_index);
}

void write_instance(const InstanceDesc& desc, uint32_t index, uint32_t entry, std::byte* address) {
  InstanceRecord record;
  std::memset(&record, 0, sizeof(record));  // padding too: same input, same bytes
  const InverseTransform inverse = *invert(desc.transform);
  std::memcpy(record.world_to_object, inverse.matrix, sizeof(inverse.matrix));
  std::memcpy(record.object_to_world, desc.transform, sizeof(desc.transform));
  record.bottom_level_address = desc.bottom_level_address;
  record.instance_index = index;
  record.id_and_mask = desc.instance_id | uint32_t{desc.instance_mask} << 24;
  record.contribution_and_flags = desc.instance_contribution_to_hit_group_index | uint32_t{desc.flags} << 24;
  record.entry = entry;
  std::memcpy(address, &record, sizeof(record));
}

}  // namespace rayloom::accel
