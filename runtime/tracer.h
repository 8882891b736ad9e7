#pragma once

// The seam between running shaders and tracing rays. The execution engine gathers the TraceRay calls of a warp's lanes
// into a batch and hands it to a tracer: the native one calls accel, the hardware model's recording tracer walks the
// structure its own way and writes down what happens. The engine also tells the tracer what the shaders do, when the
// tracer asks for it, so that the hardware model never looks inside the runtime.

#include <rayloom/accel/trace.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayloom {

enum class ShaderStage : uint8_t { ray_generation, intersection, any_hit, closest_hit, miss, callable };

/// Declared cost of one invocation of a shader, in warp instructions by class (C++ functors have no ISA to count).
struct ShaderCost {
  uint32_t alu = 16;
  uint32_t special = 0;  ///< transcendental and division instructions
};

/// A shader of the bound state object, numbered in order of definition.
struct ShaderInfo {
  std::string name;
  ShaderStage stage;
  ShaderCost cost;
};

enum class AccessKind : uint8_t { load, store };

/// What a tracer may need to know of a DispatchRays before it starts.
struct DispatchInfo {
  uint32_t width = 0, height = 0, depth = 0;
  uint32_t warp_size = 32;
  uint64_t warp_count = 0;
  std::span<const ShaderInfo> shaders;
  accel::AddressSpace addresses;
};

/// One lane's TraceRay. `structure_address` is the simulated address of the top-level structure (0: a miss).
struct TraceCall {
  uint32_t lane = 0;
  uint64_t structure_address = 0;
  uint32_t payload_bytes = 0;
  accel::TraceRequest request;
  accel::Hit hit;  ///< filled by the tracer
};

/// Sees one warp from its first instruction to its last, always from one thread. `lane` is 0..warp_size-1.
/// Calls nest: a callback shader (any-hit, intersection) begins and ends inside trace().
class WarpTracer {
 public:
  virtual ~WarpTracer() = default;

  /// Traces every call of the batch and fills its hit. Calls come in lane order.
  virtual void trace(std::span<TraceCall> calls) = 0;

  virtual void begin_shader(uint32_t /*lane*/, uint32_t /*shader*/, uint64_t /*record_address*/) {}
  virtual void end_shader(uint32_t /*lane*/) {}
  /// A shader's access to device memory; `data` holds the bytes of a store, null for a load.
  virtual void access(uint32_t /*lane*/, AccessKind, uint64_t /*address*/, uint32_t /*bytes*/, const void* /*data*/) {}
  /// A shader's own mark of the way it took (ctx.Branch(id)); lanes with different marks do not share instructions.
  virtual void branch(uint32_t /*lane*/, uint32_t /*signature*/) {}
  /// CallShader: the callable's begin_shader/end_shader follow, then the caller goes on.
  virtual void call_shader(uint32_t /*lane*/, uint32_t /*parameter_bytes*/) {}
};

/// A factory of warp tracers. begin_warp and end_warp are called from many threads; each warp stays on one.
class Tracer {
 public:
  virtual ~Tracer() = default;
  /// True when shaders should report begin/end, accesses and branches; false costs them nothing (guarantee G5).
  virtual bool observes_shaders() const = 0;
  virtual void begin_dispatch(const DispatchInfo&) {}
  /// `first_lane_index`: linear index of lane 0 is warp * warp_size; lanes past the grid's end do not run.
  virtual std::unique_ptr<WarpTracer> begin_warp(uint64_t warp) = 0;
  virtual void end_warp(uint64_t warp, std::unique_ptr<WarpTracer>) = 0;
  virtual void end_dispatch() {}
};

}  // namespace rayloom
