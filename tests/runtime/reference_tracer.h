#pragma once

// The oracle: a tracer without a tree. It tries every primitive of every instance in the order of their indices, in
// double precision, and applies flags, culling and extents as the specification's text gives them.

#include <rayloom/runtime/tracer.h>

namespace rayloom::test {

class ReferenceTracer final : public Tracer {
 public:
  bool observes_shaders() const override { return false; }
  void begin_dispatch(const DispatchInfo& info) override { addresses_ = info.addresses; }
  std::unique_ptr<WarpTracer> begin_warp(uint64_t warp) override;
  void end_warp(uint64_t, std::unique_ptr<WarpTracer>) override {}

 private:
  accel::AddressSpace addresses_;
};

}  // namespace rayloom::test
