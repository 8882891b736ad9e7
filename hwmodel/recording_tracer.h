#pragma once

// The tracer that writes captures: it walks the real structures with the scalar traversal, hands the runtime the hits,
// and keeps what every lane and every ray did. Each warp records for itself, so captures are equal for any number of
// host threads.

#include <rayloom/hwmodel/capture.h>
#include <rayloom/runtime/tracer.h>

#include <memory>
#include <mutex>
#include <vector>

namespace rayloom::hwmodel {

class RecordingTracer : public Tracer {
 public:
  bool observes_shaders() const override { return true; }
  void begin_dispatch(const DispatchInfo& info) override;
  std::unique_ptr<WarpTracer> begin_warp(uint64_t warp) override;
  void end_warp(uint64_t warp, std::unique_ptr<WarpTracer> tracer) override;
  void end_dispatch() override;

  /// One capture a DispatchRays, in order.
  const std::vector<Capture>& captures() const { return captures_; }
  std::vector<Capture> take() { return std::move(captures_); }

 private:
  std::vector<Capture> captures_;
  std::mutex structures_mutex_;
  std::vector<StructureRange> structures_;
};

}  // namespace rayloom::hwmodel
