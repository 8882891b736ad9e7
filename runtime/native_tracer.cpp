#include <rayloom/runtime/native_tracer.h>

#include <algorithm>
#include <vector>

namespace rayloom {
namespace {

class NativeWarpTracer final : public WarpTracer {
 public:
  explicit NativeWarpTracer(accel::AddressSpace addresses) : addresses_(addresses) {}

  void trace(std::span<TraceCall> calls) override {
    if (calls.size() == 1) {
      calls[0].hit = accel::trace(addresses_, calls[0].request);
      return;
    }
    requests_.resize(calls.size());
    hits_.resize(calls.size());
    std::transform(calls.begin(), calls.end(), requests_.begin(), [](const TraceCall& call) { return call.request; });
    accel::trace(addresses_, requests_, hits_);
    for (size_t i = 0; i < calls.size(); ++i) calls[i].hit = hits_[i];
  }

 private:
  accel::AddressSpace addresses_;
  std::vector<accel::TraceRequest> requests_;
  std::vector<accel::Hit> hits_;
};

}  // namespace

std::unique_ptr<WarpTracer> NativeTracer::begin_warp(uint64_t) {
  return std::make_unique<NativeWarpTracer>(addresses_);
}

}  // namespace rayloom
