#include <rayloom/runtime/device_removed.h>
#include <rayloom/runtime/run_shader.h>

namespace rayloom::detail {

void Lane::remove_device(const std::string& reason) {
  if (!failure) failure = std::make_exception_ptr(DeviceRemoved(reason));
  std::rethrow_exception(failure);
}

void Lane::low_host_stack() {
  // Any-hit and intersection shaders run on the stack of whoever traces, which is not this lane's fiber.
  if (fiber && pending) return;
  remove_device("RC-08: the host stack of a lane is exhausted; raise the pipeline stack size or fiber_stack_bytes");
}

void exceed_pipeline_stack(Lane& lane, uint32_t shader) {
  const ShaderDefinition& definition = lane.dispatch().pipeline.shaders[shader];
  lane.remove_device(
      "RC-05: shader '" + definition.name + "' needs " + std::to_string(lane.stack_used + definition.stack_bytes()) +
      " bytes of stack, the pipeline stack size is " + std::to_string(lane.dispatch().command.stack_bytes));
}

}  // namespace rayloom::detail
