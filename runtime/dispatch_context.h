#pragma once

// What all warps of a running dispatch share.

#include <rayloom/runtime/command_list.h>
#include <rayloom/runtime/device_memory.h>
#include <rayloom/runtime/dispatch.h>
#include <rayloom/runtime/pipeline.h>
#include <rayloom/runtime/record_table.h>
#include <rayloom/runtime/structure_cache.h>
#include <rayloom/runtime/validation_log.h>

namespace rayloom::detail {

struct DispatchContext {
  const DispatchCommand& command;
  const Pipeline& pipeline;
  const DeviceMemory& memory;
  ShaderMemory shader_memory;
  Tracer* tracer;  ///< null: accel traces, without anything in between
  StructureCache& structures;
  ValidationLog& log;
  ExecutionMode mode;  // warp or direct
  uint32_t warp_size;
  uint32_t lanes;  // under way at a time, on a fiber each: a warp where a tracer watches, else two
  uint64_t fiber_stack_bytes;
  bool observed;   // the tracer wants to see shaders
  bool validates;  // someone listens to the log
  RecordTable ray_generation, miss, hit_groups, callables;

  const DISPATCH_RAYS_DESC& desc() const { return command.desc; }
  uint64_t thread_count() const { return uint64_t{desc().Width} * desc().Height * desc().Depth; }
};

}  // namespace rayloom::detail
