#include <rayloom/runtime/shader_record.h>

namespace rayloom::detail {

void call_shader(Invocation& caller, uint shader_index, void* parameters, const TypeInfo& parameter_type) {
  Lane& lane = lane_of(caller);
  lane.check_alive();
  const DispatchContext& dispatch = lane.dispatch();
  const SelectedRecord selected =
      select_record(lane, dispatch.desc().CallableShaderTable, shader_index, ExportKind::callable);
  if (!selected.target) return;
  const ShaderDefinition& shader = dispatch.pipeline.shaders[selected.target->index];
  if (!(shader.payload == parameter_type)) {
    lane.report("CA-05",
                [&] { return "callable shader '" + shader.name + "' takes other parameters than CallShader gave"; });
    return;
  }
  if (dispatch.observed) lane.observer.tracer->call_shader(lane.number, parameter_type.bytes);
  Invocation invocation{&lane, nullptr, nullptr, 0, selected.record};
  run_shader(invocation, selected.target->index, parameters, nullptr);
}

}  // namespace rayloom::detail
