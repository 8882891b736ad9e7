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
  const SelectedRecord selected = select_record(lane, table, 0);
  if (!selected.target) return;
  Invocation invocation{&lane, nullptr, nullptr, 0, {&table, selected.address}};
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

}  // namespace

Warp::Warp(const DispatchContext& dispatch)
    : dispatch_(dispatch),
      grid_(dispatch.desc().Width, dispatch.desc().Height, 0),
      waiting_(dispatch.lanes + lookahead),
      batch_(dispatch, dispatch.lanes) {
  if (dispatch.mode == ExecutionMode::direct) return;
  for (uint32_t i = 0; i < dispatch.lanes; ++i) {
    fibers_.emplace_back(static_cast<size_t>(dispatch.fiber_stack_bytes), i);
    fibers_.back().start(fiber_entry, this);
  }
  for (size_t i = fibers_.size(); i > 0; --i) free_.push_back(&fibers_[i - 1].context());
  free_count_ = dispatch.lanes;
}

void Warp::run(WarpTracer* tracer, uint64_t first_lane, uint64_t lane_count) {
  tracer_ = tracer;
  first_lane_ = first_lane;
  lane_count_ = lane_count;
  observer_ = &shader_memory.observer;
  begun_ = ended_ = 0;
  grid_ = GridWalk(dispatch_.desc().Width, dispatch_.desc().Height, first_lane);
  dispatch_.mode == ExecutionMode::warp ? run_on_fibers() : run_directly();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

inline Lane Warp::new_lane() {
  const DISPATCH_RAYS_DESC& desc = dispatch_.desc();
  Lane lane;
  lane.dimensions = {desc.Width, desc.Height, desc.Depth};
  lane.warp = this;
  lane.context = &dispatch_;
  lane.counts = &statistics_;
  return lane;
}

/// `lane` becomes the next of the grid.
inline void Warp::begin(Lane& lane) {
  const GridIndex& at = *grid_;
  lane.index = {at.x, at.y, at.z};
  lane.linear_index = first_lane_ + begun_;
  lane.number = static_cast<uint32_t>(begun_);
  lane.observer = {tracer_, lane.number};
  ++begun_;
  ++grid_;
  enter(lane);
}

inline void Warp::finish(Lane& lane) {
  ++ended_;
  if (!lane.failure) [[likely]]
    return;
  if (!failure_ || lane.linear_index < failed_lane_) {
    failure_ = lane.failure;
    failed_lane_ = lane.linear_index;
  }
  lane.failure = nullptr;
}

void Warp::run_directly() {
  thread_local const uintptr_t limit = thread_stack_limit();
  Lane lane = new_lane();
  lane.stack_limit = limit;
  while (begun_ < lane_count_) {
    begin(lane);
    run_lane(lane);
    finish(lane);
  }
  *observer_ = nullptr;
}

/// A fiber's lanes, of this run and later ones, one after another. All that a lane has lies on its own stack.
void Warp::fiber_entry(void* argument) {
  Warp& warp = *static_cast<Warp*>(argument);
  Fiber::Context& fiber = *warp.free_[warp.free_count_];
  const auto top = reinterpret_cast<uintptr_t>(__builtin_frame_address(0));
  constexpr uintptr_t used_above = 4096;
  Lane lane = warp.new_lane();
  lane.fiber = &fiber;
  lane.stack_limit = top - (warp.dispatch_.fiber_stack_bytes - used_above);
  for (;;) {
    do {
      warp.begin(lane);
      run_lane(lane);
      warp.finish(lane);
    } while (warp.goes_on());
    warp.free_[warp.free_count_++] = &fiber;
    warp.give_turn(fiber);
  }
}

/// Lanes that begin together have rays that go together, so it is worth waiting until some can.
bool Warp::may_begin() const {
  constexpr uint32_t worth_beginning = 16;
  if (free_count_ == 0 || begun_ == lane_count_) return false;
  return waiting_count_ == 0 || free_count_ >= std::min(worth_beginning, dispatch_.lanes / 2);
}

/// Until all lanes under way wait.
void Warp::take_turns() {
  Fiber::Context* const first = next_fiber();
  if (!first) return;
  first->resume_in_same_modes();
  if (!(FloatModes::current() == FloatModes::fixed())) [[unlikely]]
    FloatModes::fixed().set();  // a shader has left others
  *observer_ = nullptr;
}

void Warp::run_on_fibers() {
  uint64_t outer_exceptions[2];
  exception_state_ = thread_exception_state();
  move_exception_state(exception_state_, outer_exceptions);
  waiting_count_ = traced_ = resumed_ = 0;
  do {
    beginning_ = false;
    take_turns();
    if (may_begin()) {
      beginning_ = at_once_ = true;
      take_turns();
    }
  } while (trace_waiting());
  move_exception_state(outer_exceptions, exception_state_);
}

/// Traces the gathered frames; their lanes are next to run. False: there are none.
bool Warp::trace_waiting() {
  if (waiting_count_ == 0) return false;
  // A fiber goes from lane to lane at once where lanes end together, as they do that trace as many rays each.
  at_once_ = 4 * ended_ >= 3 * uint64_t{traced_};
  ended_ = 0;
  traced_ = std::exchange(waiting_count_, 0);
  resumed_ = 0;
  try {
    batch_.trace(tracer_);
  } catch (...) {
    // The lanes are suspended inside their shaders: each must be told, to unwind on its own stack.
    for (uint32_t i = 0; i < traced_; ++i) waiting_[i].frame->failure = std::current_exception();
    batch_.clear();
  }
  return true;
}

/// Direct mode.
void Warp::trace_now(RayFrame& frame) {
  hit_ = batch_.trace_now(frame, tracer_);
  frame.hit = &hit_;
}

}  // namespace rayloom::detail
