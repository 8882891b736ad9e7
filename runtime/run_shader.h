#pragma once

// One invocation of a shader, with stack accounting, statistics and observation.

#include <rayloom/runtime/lane.h>

namespace rayloom::detail {

/// Throws DeviceRemoved for `shader` on `lane` [RC-05].
[[noreturn]] void exceed_pipeline_stack(Lane& lane, uint32_t shader);

/// By stage.
inline constexpr uint64_t DispatchStatistics::*stage_counters[] = {
    &DispatchStatistics::ray_generation, &DispatchStatistics::intersection, &DispatchStatistics::any_hit,
    &DispatchStatistics::closest_hit,    &DispatchStatistics::miss,         &DispatchStatistics::callable};

/// Brackets one invocation, however it ends.
class ShaderScope {
 public:
  ShaderScope(Lane& lane, uint32_t shader, const ShaderCode& code, uint64_t record_address)
      : lane_(lane), stack_bytes_(code.stack_bytes) {
    if (lane.stack_used + stack_bytes_ > lane.dispatch().command.stack_bytes) [[unlikely]]
      exceed_pipeline_stack(lane, shader);
    lane.check_host_stack(stack_bytes_);
    lane.stack_used += stack_bytes_;
    ++(lane.counts->*stage_counters[static_cast<size_t>(code.stage)]);
    if (lane.dispatch().observed) [[unlikely]]
      lane.observer.tracer->begin_shader(lane.number, shader, record_address);
  }
  ~ShaderScope() {
    lane_.stack_used -= stack_bytes_;
    if (lane_.dispatch().observed) [[unlikely]]
      lane_.observer.tracer->end_shader(lane_.number);
  }
  ShaderScope(const ShaderScope&) = delete;
  ShaderScope& operator=(const ShaderScope&) = delete;

 private:
  Lane& lane_;
  uint64_t stack_bytes_;
};

inline HitDecision run_shader(Invocation& invocation, uint32_t shader, void* data, const void* attributes) {
  Lane& lane = lane_of(invocation);
  const ShaderCode& code = lane.dispatch().pipeline.code[shader];
  const ShaderScope scope(lane, shader, code, invocation.record.address);
  return code.entry(code.functor, invocation, data, attributes);
}

}  // namespace rayloom::detail
