#pragma once

// Runs the lanes of a part of a grid on one thread. In warp mode a number of lanes are under way at a time, each on a
// fiber. One that traces keeps its fiber and gives its turn to the next; when all wait, their rays are traced as one
// batch and they go on, in order. A lane that ends is followed by the next of the part, on the same stack, so that
// batches stay full; lanes that go together are begun together, so that their rays stay neighbours.

#include <rayloom/base/fiber_context.h>
#include <rayloom/runtime/grid_order.h>
#include <rayloom/runtime/lane.h>
#include <rayloom/runtime/ray_batch.h>

#include <utility>
#include <vector>

namespace rayloom::detail {

/// Lives as long as the dispatch; threads hand it on between parts, never within one.
class Warp {
 public:
  explicit Warp(const DispatchContext& dispatch);
  Warp(const Warp&) = delete;
  Warp& operator=(const Warp&) = delete;

  /// Runs lanes first_lane .. first_lane + lane_count - 1 of the grid, by linear index, to their ends. Null tracer:
  /// accel. Then throws the failure of the lowest lane that has one.
  void run(WarpTracer* tracer, uint64_t first_lane, uint64_t lane_count);

  /// Of all parts run so far.
  const DispatchStatistics& statistics() const { return statistics_; }
  /// Called by a lane: returns when frame.hit is known. Inlined for what fiber_context.h says.
  [[gnu::always_inline]] void trace(Lane& lane, RayFrame& frame);

 private:
  /// A fiber whose lane waits for a hit.
  struct Waiting {
    Fiber::Context* fiber;
    RayFrame* frame;
  };

  static constexpr uint32_t lookahead = 2;  // lanes whose memory is fetched ahead of their turn

  static void fiber_entry(void* warp);
  static void prefetch(const Waiting& waiting);
  void run_on_fibers();
  void take_turns();
  void run_directly();
  Lane new_lane();
  void begin(Lane& lane);
  void finish(Lane& lane);
  bool goes_on() const { return at_once_ && begun_ < lane_count_; }
  bool may_begin() const;
  Fiber::Context* next_fiber();
  void enter(Lane& lane) const;
  void give_turn(Fiber::Context& fiber);
  void suspend(Lane& lane);
  void trace_now(RayFrame& frame);
  bool trace_waiting();

  const DispatchContext& dispatch_;
  WarpTracer* tracer_ = nullptr;
  GridWalk grid_;
  uint64_t first_lane_ = 0, lane_count_ = 0;
  uint64_t begun_ = 0, ended_ = 0;     // lanes
  uint32_t waiting_count_ = 0;         // for the next batch
  uint32_t traced_ = 0, resumed_ = 0;  // lanes of the last batch, and how many of them have gone on
  uint32_t free_count_ = 0;            // fibers
  bool beginning_ = false;             // free fibers may begin lanes
  bool at_once_ = false;               // a fiber whose lane ends begins another
  // Of the thread that runs this warp: a fiber's frames outlive the run and may go on in another thread.
  uint64_t* exception_state_ = nullptr;
  const LaneObserver** observer_ = nullptr;

  std::vector<Fiber> fibers_;
  std::vector<Fiber::Context*> free_;  // the next on top
  std::vector<Waiting> waiting_;       // in order
  RayBatch batch_;
  accel::Hit hit_;  // direct mode
  DispatchStatistics statistics_;
  std::exception_ptr failure_;  // of the lowest lane that has one
  uint64_t failed_lane_ = 0;
};

/// `lane` runs from here on.
inline void Warp::enter(Lane& lane) const {
  if (dispatch_.observed) [[unlikely]]
    *observer_ = &lane.observer;
}

/// What a lane that waits looks at first: its fiber's state and, around the frame of its TraceRay, its own frames.
/// `waiting` may be an entry out of use, whose pointers lead anywhere.
inline void Warp::prefetch(const Waiting& waiting) {
  constexpr uintptr_t line = 64, lines_below = 4, lines = 14;
  const uintptr_t lowest = reinterpret_cast<uintptr_t>(waiting.frame) - lines_below * line;
  __builtin_prefetch(waiting.fiber);
  for (uintptr_t i = 0; i < lines; ++i) __builtin_prefetch(reinterpret_cast<const void*>(lowest + i * line));
}

/// Whose turn it is: that of the next lane that has its hit, then of a fiber that may begin one. Null: neither.
inline Fiber::Context* Warp::next_fiber() {
  if (resumed_ < traced_) {
    prefetch(waiting_[resumed_ + lookahead]);
    return waiting_[resumed_++].fiber;
  }
  return beginning_ && free_count_ != 0 && begun_ < lane_count_ ? free_[--free_count_] : nullptr;
}

[[gnu::always_inline]] inline void Warp::give_turn(Fiber::Context& fiber) {
  Fiber::Context* const next = next_fiber();
  next ? fiber.yield_in_same_modes_to(*next) : fiber.yield_in_same_modes();
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

inline void Warp::trace(Lane& lane, RayFrame& frame) {
  if (!lane.fiber) return trace_now(frame);
  frame.hit = batch_.add(frame);
  waiting_[waiting_count_++] = {lane.fiber, &frame};
  lane.pending = &frame;
  suspend(lane);
  lane.pending = nullptr;
}

}  // namespace rayloom::detail
