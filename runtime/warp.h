#pragma once

// Runs the lanes of one warp. In warp mode each lane has a fiber: lanes run in order until each waits for a ray or is
// done, the waiting rays are traced as one batch, and so on until all are done. A warp never changes thread.

#include <rayloom/runtime/lane.h>
#include <rayloom/runtime/ray_frame.h>

#include <vector>

namespace rayloom::detail {

/// Fibers and lists a thread keeps from one warp to the next.
struct WarpWorkspace {
  std::vector<Fiber> fibers;
  std::vector<Lane> lanes;
  std::vector<TraceCall> calls;
  std::vector<Lane*> waiting;
};

class Warp {
 public:
  /// Lanes first_lane .. first_lane + lane_count - 1 of the grid, by linear index.
  Warp(const DispatchContext& dispatch, WarpTracer& tracer, WarpWorkspace& workspace, uint64_t first_lane,
       uint32_t lane_count);

  /// Runs all lanes to their ends. Then throws the failure of the lowest lane that has one.
  void run();

  const DispatchContext& dispatch() const { return dispatch_; }
  DispatchStatistics& statistics() { return statistics_; }
  const TopLevel& find_structure(uint64_t address);
  /// Called by a lane: returns when frame.hit is known.
  void trace(Lane& lane, RayFrame& frame);

 private:
  void start_lane(Lane& lane, uint64_t linear_index, uint32_t number);
  void run_on_fibers();
  void run_directly();
  void resume(Lane& lane);
  void trace_waiting();
  TraceCall make_call(const Lane& lane, RayFrame& frame) const;

  const DispatchContext& dispatch_;
  WarpTracer& tracer_;
  WarpWorkspace& workspace_;
  DispatchStatistics statistics_;
  uint64_t last_address_ = 0;
  const TopLevel* last_structure_ = nullptr;
};

}  // namespace rayloom::detail
