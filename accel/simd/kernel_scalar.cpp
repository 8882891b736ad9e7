#include <rayloom/accel/batch-inl.h>
#include <rayloom/accel/simd/kernel.h>

namespace rayloom::accel {

Hit scalar::trace_alone(AddressSpace addresses, const TraceRequest& request) {
  Visitor none;
  return traverse(addresses, request, none);
}

namespace {

void trace_rays(AddressSpace addresses, const RayRun& rays, Hit* hits) { scalar::trace_run(addresses, rays, hits); }

void occlude_rays(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  scalar::occlude_run(addresses, rays, results);
}

void trace_many(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits) {
  scalar::trace_batch(addresses, requests, hits);
}

}  // namespace

const Kernel scalar_kernel{scalar::trace_alone, trace_rays, occlude_rays, trace_many};

}  // namespace rayloom::accel
