#include <rayloom/runtime/run_shader.h>
#include <rayloom/runtime/shader_record.h>

namespace rayloom::detail {

void call_shader(Invocation& caller, uint shader_index, void* parameters, const TypeInfo& parameter_type) {
  Lane& lane = lane_of(caller);
  lane.check_alive();
  const DispatchContext& dispatch = lane.dispatch();
  const SelectedRecord selected = select_record(lane, dispatch.callables, shader_index);
  if (!selected.target) return;
  const uint32_t shader = selected.target->index;
  if (!(dispatch.pipeline.code[shader].payload == parameter_type))
    return lane.report("CA-05", [&] {
      return "callable shader '" + dispatch.pipeline.shaders[shader].name +
             "' takes other parameters than CallShader gave";
    });
  if (dispatch.observed) lane.observer.tracer->call_shader(lane.number, parameter_type.bytes);
  Invocation invocation{&lane, nullptr, nullptr, 0, {&dispatch.callables, selected.address}};
  run_shader(invocation, shader, parameters, nullptr);
}

}  // namespace rayloom::detail
