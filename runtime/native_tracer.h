#pragma once

// The default tracer: hands each batch to accel.

#include <rayloom/runtime/tracer.h>

namespace rayloom {

class NativeTracer final : public Tracer {
 public:
  bool observes_shaders() const override { return false; }
  void begin_dispatch(const DispatchInfo& info) override { addresses_ = info.addresses; }
  std::unique_ptr<WarpTracer> begin_warp(uint64_t warp) override;
  void end_warp(uint64_t, std::unique_ptr<WarpTracer>) override {}

 private:
  accel::AddressSpace addresses_;
};

}  // namespace rayloom
