#pragma once

// Simulated time. Everything that happens is an event, and events are handled in the order (time, component, sequence),
// so that a run is a pure function of capture and configuration.

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rayloom::hwmodel {

using Cycle = uint64_t;  ///< core clocks since the run began

/// What an event asks of the component it is for; `a`, `b`, `c` mean what the receiver's handler says.
enum class EventKind : uint16_t {
  // Dispatcher
  launch_begin,
  warp_done,
  // Sm
  warp_arrives,
  issue_done,
  warp_ready,
  loads_returned,
  trace_returned,
  callback_arrives,
  // RtCore
  entry_loaded,
  schedule,
  fetch_issue,
  fetch_returned,
  ray_tested,
  ray_popped,
  callback_returned,
  entry_returned,
  // L1Cache, L2Cache, Dram
  memory_request,
  memory_response,
  write_done,
};

struct Event {
  Cycle time = 0;
  uint64_t sequence = 0;  ///< order of scheduling; set by the queue
  uint64_t a = 0;
  uint32_t b = 0, c = 0;
  uint32_t component = 0;
  EventKind kind{};
  uint16_t detail = 0;
};

/// A binary heap. Nothing outside depends on how it is kept: a calendar queue may replace it.
class EventQueue {
 public:
  bool empty() const { return heap_.empty(); }
  void push(Event event) {
    event.sequence = next_sequence_++;
    heap_.push_back(event);
    std::push_heap(heap_.begin(), heap_.end(), later);
  }
  Event pop() {
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const Event event = heap_.back();
    heap_.pop_back();
    return event;
  }

 private:
  static bool later(const Event& x, const Event& y) {
    if (x.time != y.time) return x.time > y.time;
    if (x.component != y.component) return x.component > y.component;
    return x.sequence > y.sequence;
  }

  std::vector<Event> heap_;
  uint64_t next_sequence_ = 0;
};

}  // namespace rayloom::hwmodel
