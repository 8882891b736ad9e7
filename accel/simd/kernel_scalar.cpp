#include <rayloom/accel/simd/kernel.h>
#include <rayloom/accel/traverse-inl.h>
#include <rayloom/accel/visitor.h>

namespace rayloom::accel {
namespace {

Hit trace_one(AddressSpace addresses, const TraceRequest& request) {
  Visitor visitor;
  return scalar::traverse(addresses, request, visitor);
}

void trace_many(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits) {
  for (size_t i = 0; i < requests.size(); ++i) hits[i] = trace_one(addresses, requests[i]);
}

}  // namespace

const Kernel scalar_kernel{trace_one, trace_many};

}  // namespace rayloom::accel
