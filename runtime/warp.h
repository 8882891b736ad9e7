#pragma once

// Runs warps of lanes, one after another, on one thread. In warp mode a lane that traces keeps its fiber and gives its
// turn to the next lane: all run in order until each waits for a ray or is done, the waiting rays are traced as one
// batch, and so on until all are done. A lane that never traces costs no switch, for the next one begins on the same
// fiber.

#include <rayloom/base/fiber_context.h>
#include <rayloom/runtime/grid_order.h>
#include <rayloom/runtime/lane.h>
#include <rayloom/runtime/ray_frame.h>

#include <cstring>
#include <utility>
#include <vector>

namespace rayloom::detail {

/// Lives as long as the dispatch; threads hand it on between warps, never within one.
class Warp {
 public:
  explicit Warp(const DispatchContext& dispatch);
  Warp(const Warp&) = delete;
  Warp& operator=(const Warp&) = delete;

  /// Runs lanes first_lane .. first_lane + lane_count - 1 of the grid, by linear index, to their ends. Null tracer:
  /// accel. Then throws the failure of the lowest lane that has one.
  void run(WarpTracer* tracer, uint64_t first_lane, uint32_t lane_count);

  /// Of all warps run so far.
  const DispatchStatistics& statistics() const { return statistics_; }
  /// What lies at an address other than 0.
  const TopLevel& structure(uint64_t address) {
    if (address != structure_address_) [[unlikely]]
      change_structure(address);
    return *structure_;
  }
  /// Called by a lane: returns when frame.hit is known. Inlined for what fiber_context.h says.
  [[gnu::always_inline]] void trace(Lane& lane, RayFrame& frame);

 private:
  static void fiber_entry(void* warp);
  void run_on_fibers();
  void run_directly();
  Lane* begin_lane();
  Fiber* next_fiber();
  void enter(Lane& lane) const;
  void give_turn(Fiber& fiber);
  void suspend(Lane& lane);
  void fill_request(accel::TraceRequest& request, RayFrame& frame) const;
  accel::CandidateFunction candidate_function(const RayFrame& frame) const;
  void trace_now(RayFrame& frame);
  void trace_waiting();
  void trace_by_tracer(size_t count);
  void change_structure(uint64_t address);

  const DispatchContext& dispatch_;
  WarpTracer* tracer_ = nullptr;
  GridWalk grid_;
  uint64_t first_lane_ = 0;
  uint32_t lane_count_ = 0;
  uint32_t begun_ = 0;                 // lanes
  uint32_t fibers_used_ = 0;           // by lanes that have begun
  uint32_t waiting_count_ = 0;         // frames gathered for the next batch
  uint32_t traced_ = 0, resumed_ = 0;  // frames of the last batch, and how many of them have gone on
  // Of the thread that runs this warp: a fiber's frames outlive the warp and may go on in another thread.
  uint64_t* exception_state_ = nullptr;
  const LaneObserver** observer_ = nullptr;

  std::vector<Lane> lanes_;
  std::vector<Fiber> fibers_;
  std::vector<RayFrame*> waiting_;  // of the lanes that wait, in order
  std::vector<accel::TraceRequest> requests_;
  std::vector<accel::Hit> hits_;
  std::vector<TraceCall> calls_;  // for tracers other than accel
  DispatchStatistics statistics_;
  uint64_t structure_address_ = 0;  // of the last structure traced
  const TopLevel* structure_ = nullptr;
};

/// `lane` runs from here on.
inline void Warp::enter(Lane& lane) const {
  if (dispatch_.observed) [[unlikely]]
    *observer_ = &lane.observer;
}

/// Whose turn it is: a free fiber's while there are lanes to begin, then those of the lanes that have their hits. Null:
/// all wait or are done.
inline Fiber* Warp::next_fiber() {
  if (begun_ < lane_count_) return &fibers_[fibers_used_++];
  return resumed_ < traced_ ? waiting_[resumed_++]->lane->fiber : nullptr;
}

[[gnu::always_inline]] inline void Warp::give_turn(Fiber& fiber) {
  Fiber* const next = next_fiber();
  next ? fiber.context().yield_in_same_modes_to(next->context()) : fiber.context().yield_in_same_modes();
}

// The C++ runtime keeps the exceptions a thread is handling in 16 bytes (Itanium C++ ABI 2.2.2). Each lane gets its
// own, so that a shader may trace inside a catch block. They are nearly always zero.
inline void move_exception_state(uint64_t* from, uint64_t* to) {
  to[0] = std::exchange(from[0], 0);
  to[1] = std::exchange(from[1], 0);
}

[[gnu::always_inline]] inline void Warp::suspend(Lane& lane) {
  const bool handles = (exception_state_[0] | exception_state_[1]) != 0;
  if (handles) [[unlikely]]
    move_exception_state(exception_state_, lane.exception_state);
  give_turn(*lane.fiber);
  if (handles) [[unlikely]]
    move_exception_state(lane.exception_state, exception_state_);
  enter(lane);
}

inline accel::CandidateFunction Warp::candidate_function(const RayFrame& frame) const {
  if (!dispatch_.pipeline.decides_candidates) return nullptr;
  // A tracer of its own is told what the program is; accel only what can come up.
  if (dispatch_.tracer || (frame.scene && frame.scene->asks(frame.traversal_flags))) return decide_candidate;
  return nullptr;
}

inline void Warp::fill_request(accel::TraceRequest& request, RayFrame& frame) const {
  std::memcpy(&request.ray, &frame.arguments->desc, sizeof(request.ray));
  request.structure = frame.scene ? frame.scene->block : nullptr;
  request.ray_flags = frame.traversal_flags;
  request.instance_mask = frame.arguments->instance_mask & 0xFFu;
  request.candidate = candidate_function(frame);
  request.user = &frame;
}

inline void Warp::trace(Lane& lane, RayFrame& frame) {
  if (!lane.fiber) return trace_now(frame);
  const uint32_t slot = waiting_count_++;
  waiting_[slot] = &frame;
  fill_request(requests_[slot], frame);
  lane.pending = &frame;
  suspend(lane);
  lane.pending = nullptr;
  frame.hit = &hits_[slot];
}

}  // namespace rayloom::detail
