#pragma once

// Executes one recorded command.

#include <rayloom/runtime/command_list.h>
#include <rayloom/runtime/dispatch.h>
#include <rayloom/runtime/validation_log.h>

#include <span>

namespace rayloom::detail {

DispatchReport dispatch_rays(const DispatchCommand& command, const DispatchOptions& options, const DeviceMemory& memory,
                             ValidationLog& log);
void build_acceleration_structure(const BuildCommand& command, const DeviceMemory& memory, ValidationLog& log);
RAYTRACING_ACCELERATION_STRUCTURE_PREBUILD_INFO prebuild_info(
    const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS& inputs, std::span<const RAYTRACING_GEOMETRY_DESC> geometries);
/// The geometry descs an inputs struct points at, from either layout (BI-02).
std::vector<RAYTRACING_GEOMETRY_DESC> copy_geometries(const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS& inputs);

/// Room one fiber needs for a pipeline of this stack size; shaders' own frames are larger than what they declare.
inline constexpr uint64_t default_fiber_stack_bytes = 256 * 1024;
inline constexpr uint64_t max_pipeline_stack_bytes = 16 * 1024 * 1024;

}  // namespace rayloom::detail
