#include <rayloom/hwmodel/capture.h>

namespace rayloom::hwmodel {

const char* request_class_name(RequestClass request_class) {
  constexpr const char* names[] = {"top_node", "bottom_node", "leaf", "instance", "shader_record", "shader_data"};
  return names[static_cast<size_t>(request_class)];
}

const char* ray_event_kind_name(RayEventKind kind) {
  constexpr const char* names[] = {"node",           "triangle leaf",  "procedural leaf",
                                   "enter instance", "leave instance", "candidate"};
  return names[static_cast<size_t>(kind)];
}

namespace {

uint64_t memory_of(const WarpCapture& warp) {
  return warp.lanes.size() * sizeof(LaneCapture) + warp.segments.size() * sizeof(Segment) +
         warp.accesses.size() * sizeof(MemoryAccess) + warp.store_data.size() + warp.rays.size() * sizeof(RayCapture) +
         warp.events.size() * sizeof(RayEvent) + warp.candidates.size() * sizeof(CandidateCapture) +
         sizeof(WarpCapture);
}

void count_events(const WarpCapture& warp, CaptureCounts& counts) {
  for (const RayEvent& event : warp.events) switch (event.kind) {
      case RayEventKind::node:
        ++counts.nodes;
        break;
      case RayEventKind::triangle_leaf:
        ++counts.triangle_leaves;
        break;
      case RayEventKind::procedural_leaf:
        ++counts.procedural_leaves;
        break;
      case RayEventKind::enter_instance:
        ++counts.instances;
        break;
      case RayEventKind::leave_instance:
        break;
      case RayEventKind::candidate:
        ++counts.candidates;
        break;
    }
}

}  // namespace

CaptureCounts& CaptureCounts::operator+=(const CaptureCounts& other) {
  for (auto member :
       {&CaptureCounts::warps, &CaptureCounts::lanes, &CaptureCounts::segments, &CaptureCounts::accesses,
        &CaptureCounts::rays, &CaptureCounts::nodes, &CaptureCounts::triangle_leaves, &CaptureCounts::procedural_leaves,
        &CaptureCounts::instances, &CaptureCounts::candidates, &CaptureCounts::bytes})
    this->*member += other.*member;
  return *this;
}

CaptureCounts count(const Capture& capture) {
  CaptureCounts counts;
  counts.warps = capture.warps.size();
  for (const WarpCapture& warp : capture.warps) {
    counts.lanes += warp.lanes.size();
    counts.segments += warp.segments.size();
    counts.accesses += warp.accesses.size();
    counts.rays += warp.rays.size();
    counts.bytes += memory_of(warp);
    count_events(warp, counts);
  }
  return counts;
}

}  // namespace rayloom::hwmodel
