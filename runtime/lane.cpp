#include <rayloom/runtime/device_removed.h>
#include <rayloom/runtime/lane.h>
#include <rayloom/runtime/warp.h>

namespace rayloom::detail {
namespace {

/// Host stack left for a shader's own frames and for what it calls in the engine.
constexpr uint64_t host_stack_reserve = 32 * 1024;

uint64_t& counter(DispatchStatistics& statistics, ShaderStage stage) {
  switch (stage) {
    case ShaderStage::ray_generation:
      return statistics.ray_generation;
    case ShaderStage::intersection:
      return statistics.intersection;
    case ShaderStage::any_hit:
      return statistics.any_hit;
    case ShaderStage::closest_hit:
      return statistics.closest_hit;
    case ShaderStage::miss:
      return statistics.miss;
    default:
      return statistics.callable;
  }
}

/// Brackets one invocation, however it ends.
class ShaderScope {
 public:
  ShaderScope(Lane& lane, uint32_t shader, const ShaderDefinition& definition, uint64_t record_address)
      : lane_(lane), stack_bytes_(definition.stack_bytes()) {
    const uint64_t available = lane.dispatch().command.stack_bytes;
    if (lane.stack_used + stack_bytes_ > available)
      lane.remove_device("RC-05: shader '" + definition.name + "' needs " +
                         std::to_string(lane.stack_used + stack_bytes_) +
                         " bytes of stack, the pipeline stack size is " + std::to_string(available));
    lane.check_host_stack(stack_bytes_);
    lane.stack_used += stack_bytes_;
    ++counter(lane.statistics(), definition.stage);
    if (lane.dispatch().observed) lane.observer.tracer->begin_shader(lane.number, shader, record_address);
  }
  ~ShaderScope() {
    lane_.stack_used -= stack_bytes_;
    if (lane_.dispatch().observed) lane_.observer.tracer->end_shader(lane_.number);
  }
  ShaderScope(const ShaderScope&) = delete;
  ShaderScope& operator=(const ShaderScope&) = delete;

 private:
  Lane& lane_;
  uint64_t stack_bytes_;
};

}  // namespace

const DispatchContext& Lane::dispatch() const { return warp->dispatch(); }
DispatchStatistics& Lane::statistics() const { return warp->statistics(); }

void Lane::remove_device(const std::string& reason) {
  if (!failure) failure = std::make_exception_ptr(DeviceRemoved(reason));
  std::rethrow_exception(failure);
}

void Lane::check_host_stack(uint64_t shader_bytes) {
  const auto here = reinterpret_cast<uintptr_t>(__builtin_frame_address(0));
  // Any-hit and intersection shaders run on the stack of whoever traces, which is not this lane's fiber.
  if (fiber && pending) return;
  if (here < stack_limit || here - stack_limit < host_stack_reserve + 2 * shader_bytes)
    remove_device("RC-08: the host stack of a lane is exhausted; raise the pipeline stack size or fiber_stack_bytes");
}

HitDecision run_shader(Invocation& invocation, uint32_t shader, void* data, const void* attributes) {
  Lane& lane = lane_of(invocation);
  const ShaderDefinition& definition = lane.dispatch().pipeline.shaders[shader];
  const ShaderScope scope(lane, shader, definition, invocation.record.address);
  return definition.entry(definition.functor.get(), invocation, data, attributes);
}

}  // namespace rayloom::detail
