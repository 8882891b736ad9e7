#include <rayloom/runtime/grid_order.h>
#include <rayloom/runtime/warp.h>

#include <algorithm>
#include <cstring>
#include <cxxabi.h>
#include <pthread.h>

namespace rayloom::detail {
namespace {

/// The C++ runtime keeps the exceptions a thread is handling in 16 bytes (Itanium C++ ABI 2.2.2). Each lane gets its
/// own, so that a shader may trace inside a catch block.
class ExceptionStateScope {
 public:
  explicit ExceptionStateScope(Lane& lane) : lane_(lane) {
    std::memcpy(outer_, state(), sizeof(outer_));
    std::memcpy(state(), lane.exception_state, sizeof(outer_));
  }
  ~ExceptionStateScope() {
    std::memcpy(lane_.exception_state, state(), sizeof(outer_));
    std::memcpy(state(), outer_, sizeof(outer_));
  }
  ExceptionStateScope(const ExceptionStateScope&) = delete;
  ExceptionStateScope& operator=(const ExceptionStateScope&) = delete;

 private:
  static void* state() { return abi::__cxa_get_globals(); }
  Lane& lane_;
  uint64_t outer_[2];
};

/// Lowest usable address of this thread's own stack.
uintptr_t thread_stack_limit() {
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return 0;
  void* lowest = nullptr;
  size_t bytes = 0, guard = 0;
  pthread_attr_getstack(&attributes, &lowest, &bytes);
  pthread_attr_getguardsize(&attributes, &guard);
  pthread_attr_destroy(&attributes);
  // Traversal runs on this stack too; the rest is what shaders may use.
  constexpr uintptr_t traversal_reserve = 256 * 1024;
  return reinterpret_cast<uintptr_t>(lowest) + guard + traversal_reserve;
}

void run_ray_generation(Lane& lane) {
  const GPU_VIRTUAL_ADDRESS_RANGE& range = lane.dispatch().desc().RayGenerationShaderRecord;
  const SelectedRecord selected =
      select_record(lane, {range.StartAddress, range.SizeInBytes, 0}, 0, ExportKind::ray_generation);
  if (!selected.target) return;
  Invocation invocation{&lane, nullptr, nullptr, 0, selected.record};
  run_shader(invocation, selected.target->index, nullptr, nullptr);
}

/// A lane from beginning to end; nothing is thrown out of it.
void run_lane(Lane& lane) {
  try {
    run_ray_generation(lane);
  } catch (...) {
    if (!lane.failure) lane.failure = std::current_exception();
  }
}

void fiber_entry(void* argument) {
  Lane& lane = *static_cast<Lane*>(argument);
  const auto top = reinterpret_cast<uintptr_t>(__builtin_frame_address(0));
  constexpr uintptr_t used_above = 4096;
  lane.stack_limit = top - (lane.dispatch().fiber_stack_bytes - used_above);
  run_lane(lane);
}

}  // namespace

Warp::Warp(const DispatchContext& dispatch, WarpTracer& tracer, WarpWorkspace& workspace, uint64_t first_lane,
           uint32_t lane_count)
    : dispatch_(dispatch), tracer_(tracer), workspace_(workspace) {
  workspace_.lanes.clear();
  workspace_.lanes.resize(lane_count);
  for (uint32_t i = 0; i < lane_count; ++i) start_lane(workspace_.lanes[i], first_lane + i, i);
}

void Warp::start_lane(Lane& lane, uint64_t linear_index, uint32_t number) {
  const DISPATCH_RAYS_DESC& desc = dispatch_.desc();
  const GridIndex at = grid_index(desc.Width, desc.Height, linear_index);
  lane.index = {at.x, at.y, at.z};
  lane.dimensions = {desc.Width, desc.Height, desc.Depth};
  lane.warp = this;
  lane.linear_index = linear_index;
  lane.number = number;
  lane.observer = {&tracer_, number};
}

void Warp::run() {
  dispatch_.mode == ExecutionMode::warp ? run_on_fibers() : run_directly();
  for (const Lane& lane : workspace_.lanes)
    if (lane.failure) std::rethrow_exception(lane.failure);
}

void Warp::run_directly() {
  thread_local const uintptr_t limit = thread_stack_limit();
  for (Lane& lane : workspace_.lanes) {
    lane.stack_limit = limit;
    if (dispatch_.observed) shader_memory.observer = &lane.observer;
    run_lane(lane);
    shader_memory.observer = nullptr;
  }
}

void Warp::run_on_fibers() {
  while (workspace_.fibers.size() < workspace_.lanes.size())
    workspace_.fibers.emplace_back(static_cast<size_t>(dispatch_.fiber_stack_bytes));
  for (Lane& lane : workspace_.lanes) {
    lane.fiber = &workspace_.fibers[lane.number];
    lane.fiber->start(fiber_entry, &lane);
    resume(lane);
  }
  for (;;) {
    workspace_.waiting.clear();
    for (Lane& lane : workspace_.lanes)
      if (lane.pending) workspace_.waiting.push_back(&lane);
    if (workspace_.waiting.empty()) return;
    trace_waiting();
    for (Lane* lane : workspace_.waiting) {
      lane->pending = nullptr;
      resume(*lane);
    }
  }
}

void Warp::resume(Lane& lane) {
  if (dispatch_.observed) shader_memory.observer = &lane.observer;
  {
    const ExceptionStateScope exceptions(lane);
    lane.fiber->resume();
  }
  shader_memory.observer = nullptr;
}

TraceCall Warp::make_call(const Lane& lane, RayFrame& frame) const {
  TraceCall call;
  call.lane = lane.number;
  call.structure_address = frame.scene ? frame.arguments->structure : 0;
  call.payload_bytes = frame.payload_type.bytes;
  std::memcpy(&call.request.ray, &frame.desc, sizeof(call.request.ray));
  call.request.structure = frame.scene ? frame.scene->block : nullptr;
  call.request.ray_flags = frame.traversal_flags;
  call.request.instance_mask = frame.arguments->instance_mask & 0xFFu;
  call.request.candidate = dispatch_.pipeline.decides_candidates ? decide_candidate : nullptr;
  call.request.user = &frame;
  return call;
}

void Warp::trace_waiting() {
  workspace_.calls.clear();
  for (const Lane* lane : workspace_.waiting) workspace_.calls.push_back(make_call(*lane, *lane->pending));
  try {
    tracer_.trace(workspace_.calls);
  } catch (...) {
    // The lanes are suspended inside their shaders: each must be told, to unwind on its own stack.
    for (Lane* lane : workspace_.waiting) lane->pending->failure = std::current_exception();
  }
  for (size_t i = 0; i < workspace_.calls.size(); ++i) workspace_.waiting[i]->pending->hit = workspace_.calls[i].hit;
}

void Warp::trace(Lane& lane, RayFrame& frame) {
  if (lane.fiber) {
    lane.pending = &frame;
    lane.fiber->yield();
  } else {
    TraceCall call = make_call(lane, frame);
    tracer_.trace({&call, 1});
    frame.hit = call.hit;
  }
}

const TopLevel& Warp::find_structure(uint64_t address) {
  if (address != last_address_) {
    last_structure_ = &dispatch_.structures.find(address);
    last_address_ = address;
  }
  return *last_structure_;
}

}  // namespace rayloom::detail
