#pragma once

// The scalar traversal with a visitor that sees every step, for the hardware model and for tests. It takes the same way
// through the structure as trace() and returns the same hit.

#include <rayloom/accel/traverse-inl.h>
#include <rayloom/accel/visitor.h>
#include <rayloom/base/float_environment.h>

namespace rayloom::accel {

/// `visitor` is a class derived from Visitor.
template <class RecordingVisitor>
Hit walk(AddressSpace addresses, const TraceRequest& request, RecordingVisitor& visitor) {
  const FloatEnvironment environment;
  return scalar::traverse<true>(addresses, request, visitor);
}

}  // namespace rayloom::accel
