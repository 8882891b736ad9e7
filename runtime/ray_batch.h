#pragma once

// The rays that lanes wait for. Calls of TraceRay that agree in structure, flags and mask make a group: what follows
// from these is found out once, and the group's rays go to accel side by side. Calls whose candidates shaders decide,
// and all calls where a tracer watches, keep a request each, in the order they were made.

#include <rayloom/runtime/dispatch_context.h>
#include <rayloom/runtime/ray_frame.h>

#include <cstring>
#include <exception>
#include <vector>

namespace rayloom::detail {

class RayBatch {
 public:
  /// Holds `capacity` rays.
  RayBatch(const DispatchContext& dispatch, uint32_t capacity);

  bool empty() const { return size_ == 0; }
  uint32_t size() const { return size_; }
  /// Fills frame.scene. The hit is there after trace(), and lasts until the next.
  const accel::Hit* add(RayFrame& frame);
  /// Finds all hits, by accel where there is no tracer, and empties the batch.
  void trace(WarpTracer* tracer);
  /// Forgets the rays.
  void clear();
  /// Fills frame.scene and traces this ray alone.
  accel::Hit trace_now(RayFrame& frame, WarpTracer* tracer);

 private:
  struct Group {
    uint64_t address = 0;         // of the structure, as TraceRay was given it
    uint flags = 0;               // of TraceRay, the defined ones
    uint mask = 0;                // low 8 bits
    bool apart = false;           // each ray needs its own request
    bool only_occlusion = false;  // nobody asks for more than whether there is a hit
    uint32_t count = 0;
    const TopLevel* scene = nullptr;  // null: the rays miss
    accel::TraceRequest shared;
    std::vector<accel::Ray> rays;
    std::vector<accel::Hit> hits;

    bool takes(const TraceRayArguments& call) const {
      return address == call.structure && flags == call.flags && mask == (call.instance_mask & 0xFFu);
    }
  };
  static constexpr size_t most_groups = 16;

  Group& group_of(const TraceRayArguments& call) {
    if (current_->takes(call)) [[likely]]
      return *current_;
    return change_group(call);
  }
  Group& change_group(const TraceRayArguments& call);
  Group& unused_group();
  void define(Group& group, const TraceRayArguments& call);
  const accel::Hit* add_apart(RayFrame& frame, const Group& group);
  void trace_group(Group& group);
  void trace_by_tracer(WarpTracer& tracer, size_t count);

  const DispatchContext& dispatch_;
  uint32_t capacity_;
  uint32_t size_ = 0;
  Group* current_;
  std::vector<Group> groups_;  // never grows beyond what is reserved
  Group overflow_;             // for calls that find all groups in use
  size_t apart_count_ = 0;
  std::vector<accel::TraceRequest> requests_;  // of rays apart
  std::vector<accel::Hit> hits_;               // of the same
  std::vector<uint8_t> occluded_;
  std::vector<TraceCall> calls_;  // for tracers other than accel
};

inline const accel::Hit* RayBatch::add(RayFrame& frame) {
  Group& group = group_of(*frame.arguments);
  ++size_;
  frame.scene = group.scene;
  if (group.apart) [[unlikely]]
    return add_apart(frame, group);
  const uint32_t slot = group.count++;
  std::memcpy(&group.rays[slot], &frame.arguments->desc, sizeof(accel::Ray));
  return &group.hits[slot];
}

}  // namespace rayloom::detail
