#pragma once

// What top-level builds and updates make of one instance desc.

#include <rayloom/accel/box.h>
#include <rayloom/accel/build.h>
#include <rayloom/accel/layout.h>

#include <optional>

namespace rayloom::accel {

/// Instances conditioned worse than this would widen every box of the structure too much; they are visited always.
inline constexpr double max_conditioning = 1024;

/// World box of an active instance; a point at its origin when nothing in it is active (PR-14). Empty for inactive
/// ones: null address (PR-05), NaN or no inverse in the transform. Throws InputError, naming instance `index`, for an
/// address that is no bottom-level structure.
std::optional<Box> instance_box(const InstanceDesc& desc, AddressSpace addresses, uint32_t index,
                                const BuildSettings& settings);

/// Whether no ray can hit anything in an active instance: such ones are kept for updates only.
bool is_hidden(const InstanceDesc& desc, AddressSpace addresses);

/// Of an active instance's transform.
double conditioning(const InstanceDesc& desc);

/// 1 + `largest`, rounded up: StructureHeader::pad_scale from the largest conditioning up to max_conditioning.
float pad_scale_for(double largest);

/// Makes the header of a finished top level one of a lazy structure if it is over such.
void note_lazy_instances(std::span<const InstanceDesc> instances, AddressSpace addresses, StructureHeader& header);

/// Writes the InstanceRecord of an active instance, `entry` as there.
void write_instance(const InstanceDesc& desc, uint32_t index, uint32_t entry, std::byte* address);

}  // namespace rayloom::accel
