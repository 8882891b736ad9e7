#pragma once

#include <rayloom/accel/ray_run.h>

namespace rayloom::accel {

/// The entry points of one instruction set. They expect the fixed FloatEnvironment.
struct Kernel {
  Hit (*trace_one)(AddressSpace, const TraceRequest&);
  void (*trace_rays)(AddressSpace, const RayRun&, Hit*);
  void (*occlude_rays)(AddressSpace, const RayRun&, uint8_t*);
  void (*trace_many)(AddressSpace, std::span<const TraceRequest>, std::span<Hit>);
};

extern const Kernel scalar_kernel;

/// Null where this build has no such kernel or the CPU lacks the instructions.
const Kernel* highway_kernel(Isa isa);

}  // namespace rayloom::accel
