#include <rayloom/base/float_modes.h>
#include <rayloom/runtime/run_shader.h>
#include <rayloom/runtime/warp.h>

#include <algorithm>
#include <cstring>
#include <cxxabi.h>
#include <pthread.h>

namespace rayloom::detail {
namespace {

uint64_t* thread_exception_state() { return reinterpret_cast<uint64_t*>(abi::__cxa_get_globals()); }

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
  const RecordTable& table = lane.dispatch().ray_generation;
  const Export* target = table.first;
  if (!target) [[unlikely]] {
    target = select_record(lane, table, 0).target;
    if (!target) return;
  }
  Invocation invocation{&lane, nullptr, nullptr, 0, {&table, table.range.StartAddress}};
  run_shader(invocation, target->index, nullptr, nullptr);
}

/// A lane from beginning to end; nothing is thrown out of it.
void run_lane(Lane& lane) {
  try {
    run_ray_generation(lane);
  } catch (...) {
    if (!lane.failure) lane.failure = std::current_exception();
  }
}

TraceCall call_of(const RayFrame& frame, const accel::TraceRequest& request) {
  return {frame.lane->number, frame.scene ? frame.arguments->structure : 0, frame.payload_type.bytes, request, {}};
}

}  // namespace

Warp::Warp(const DispatchContext& dispatch)
    : dispatch_(dispatch),
      grid_(dispatch.desc().Width, dispatch.desc().Height, 0),
      lanes_(dispatch.warp_size),
      waiting_(dispatch.warp_size),
      requests_(dispatch.warp_size),
      hits_(dispatch.warp_size) {
  const DISPATCH_RAYS_DESC& desc = dispatch.desc();
  for (uint32_t i = 0; i < dispatch.warp_size; ++i) {
    Lane& lane = lanes_[i];
    lane.dimensions = {desc.Width, desc.Height, desc.Depth};
    lane.warp = this;
    lane.context = &dispatch;
    lane.counts = &statistics_;
    lane.number = i;
    if (dispatch.mode == ExecutionMode::direct) continue;
    fibers_.emplace_back(static_cast<size_t>(dispatch.fiber_stack_bytes), i);
    fibers_.back().start(fiber_entry, this);
  }
}

void Warp::run(WarpTracer* tracer, uint64_t first_lane, uint32_t lane_count) {
  tracer_ = tracer;
  first_lane_ = first_lane;
  lane_count_ = lane_count;
  observer_ = &shader_memory.observer;
  begun_ = fibers_used_ = waiting_count_ = traced_ = resumed_ = 0;
  grid_ = GridWalk(dispatch_.desc().Width, dispatch_.desc().Height, first_lane);
  dispatch_.mode == ExecutionMode::warp ? run_on_fibers() : run_directly();
  std::exception_ptr failure;
  for (Lane& lane : lanes_) {
    if (!lane.failure) [[likely]]
      continue;
    if (!failure) failure = lane.failure;
    lane.failure = nullptr;
  }
  if (failure) std::rethrow_exception(failure);
}

/// The next lane that has not begun, ready to run; null when all have.
inline Lane* Warp::begin_lane() {
  if (begun_ == lane_count_) return nullptr;
  Lane& lane = lanes_[begun_];
  const GridIndex& at = *grid_;
  lane.index = {at.x, at.y, at.z};
  lane.linear_index = first_lane_ + begun_;
  lane.observer = {tracer_, begun_};
  ++begun_;
  ++grid_;
  return &lane;
}

void Warp::run_directly() {
  thread_local const uintptr_t limit = thread_stack_limit();
  while (Lane* const lane = begin_lane()) {
    lane->stack_limit = limit;
    enter(*lane);
    run_lane(*lane);
  }
  *observer_ = nullptr;
}

/// A fiber begins lanes until one of them waits, and goes on to begin others, of this or a later warp, when it is free.
void Warp::fiber_entry(void* argument) {
  Warp& warp = *static_cast<Warp*>(argument);
  Fiber& fiber = warp.fibers_[warp.fibers_used_ - 1];
  const auto top = reinterpret_cast<uintptr_t>(__builtin_frame_address(0));
  constexpr uintptr_t used_above = 4096;
  const uintptr_t limit = top - (warp.dispatch_.fiber_stack_bytes - used_above);
  for (;;) {
    while (Lane* const lane = warp.begin_lane()) {
      lane->fiber = &fiber;
      lane->stack_limit = limit;
      warp.enter(*lane);
      run_lane(*lane);
    }
    warp.give_turn(fiber);
  }
}

void Warp::run_on_fibers() {
  uint64_t outer_exceptions[2];
  exception_state_ = thread_exception_state();
  move_exception_state(exception_state_, outer_exceptions);
  while (Fiber* const fiber = next_fiber()) {
    fiber->context().resume_in_same_modes();
    if (!(FloatModes::current() == FloatModes::fixed())) [[unlikely]]
      FloatModes::fixed().set();  // a shader has left others
    *observer_ = nullptr;
    if (waiting_count_ != 0) trace_waiting();
  }
  move_exception_state(outer_exceptions, exception_state_);
}

/// Traces the gathered frames; their lanes are next to run.
void Warp::trace_waiting() {
  traced_ = std::exchange(waiting_count_, 0);
  resumed_ = 0;
  try {
    if (tracer_) return trace_by_tracer(traced_);
    accel::trace(dispatch_.memory.addresses(), {requests_.data(), traced_}, {hits_.data(), traced_});
  } catch (...) {
    // The lanes are suspended inside their shaders: each must be told, to unwind on its own stack.
    for (uint32_t i = 0; i < traced_; ++i) waiting_[i]->failure = std::current_exception();
  }
}

void Warp::trace_by_tracer(size_t count) {
  calls_.clear();
  for (size_t i = 0; i < count; ++i) calls_.push_back(call_of(*waiting_[i], requests_[i]));
  tracer_->trace(calls_);
  for (size_t i = 0; i < count; ++i) hits_[i] = calls_[i].hit;
}

/// Direct mode.
void Warp::trace_now(RayFrame& frame) {
  accel::TraceRequest& request = requests_[0];
  fill_request(request, frame);
  frame.hit = &hits_[0];
  if (!tracer_) {
    hits_[0] = accel::trace(dispatch_.memory.addresses(), request);
  } else {
    TraceCall call = call_of(frame, request);
    tracer_->trace({&call, 1});
    hits_[0] = call.hit;
  }
}

void Warp::change_structure(uint64_t address) {
  structure_ = &dispatch_.structures.find(address);
  structure_address_ = address;
}

}  // namespace rayloom::detail
