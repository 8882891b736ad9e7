#include <rayloom/accel/instance_leaf.h>
#include <rayloom/accel/refit.h>
#include <rayloom/base/float_environment.h>

namespace rayloom::accel {
namespace {

constexpr float largest = std::numeric_limits<float>::max();

/// Structures that may be updated are not re-braided, so instances are entered at their roots. One that has become
/// inactive keeps its record for a later update; its box is empty.
Refitted refit_instance(std::span<const InstanceDesc> instances, AddressSpace addresses, const BuildSettings& settings,
                        std::byte* address) {
  const uint32_t index = reinterpret_cast<const InstanceRecord*>(address)->instance_index;
  const InstanceDesc& desc = instances[index];
  const auto box = instance_box(desc, addresses, index, settings);
  if (!box) return {};
  write_instance(desc, index, 0, address);
  const double condition = conditioning(desc);
  if (condition <= max_conditioning) return {*box, *box, 0, condition};
  return {{{-largest, -largest, -largest}, {largest, largest, largest}}, *box, 0, 0};
}

}  // namespace

uint64_t refit_top_level(std::span<const InstanceDesc> instances, AddressSpace addresses, const BuildSettings& settings,
                         const std::byte* source, std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_update(source, result, StructureKind::instances, instances.size(), 0, settings);
  StructureHeader& header = *reinterpret_cast<StructureHeader*>(result.data());
  const uint64_t bytes = update(source, result.data(), settings, [&](std::byte* address) {
    return refit_instance(instances, addresses, settings, address);
  });
  header.non_opaque_count = 0;
  for (const InstanceDesc& desc : instances)
    header.non_opaque_count += (desc.flags & instance_flag::force_non_opaque) != 0;
  note_lazy_instances(instances, addresses, header);
  return bytes;
}

}  // namespace rayloom::accel
