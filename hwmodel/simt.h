#pragma once

// How the lanes of a warp share instructions. Lanes reconverge at the end of a call: of those that can go on, the ones
// deepest in their call stacks run first, and among these the lanes with the same shader and branch signature run
// together, one such group after the other. So a step costs the sum over distinct groups of the maximum over lanes.

#include <rayloom/hwmodel/capture.h>
#include <rayloom/hwmodel/memory.h>

#include <cstdint>
#include <vector>

namespace rayloom::hwmodel {

using LaneMask = uint64_t;
inline constexpr uint32_t max_warp_size = 64;

/// Calls function(lane) for each lane of `lanes`, lowest first.
template <class Function>
void for_each_lane(LaneMask lanes, Function&& function) {
  for (; lanes; lanes &= lanes - 1) function(static_cast<uint32_t>(__builtin_ctzll(lanes)));
}
inline uint32_t lane_count(LaneMask lanes) { return static_cast<uint32_t>(__builtin_popcountll(lanes)); }

/// Lanes that run one stretch of one shader together.
struct LaneGroup {
  LaneMask lanes = 0;
  uint32_t shader = 0;
  uint32_t alu = 0, special = 0;  ///< warp instructions: the maximum over the lanes
  uint64_t lane_operations = 0;   ///< the sum over the lanes, both classes
  uint32_t invocations = 0;       ///< lanes that begin the shader here
  uint32_t accesses = 0;          ///< memory instructions, the record read included
};

class Simt {
 public:
  /// Lane l runs segments [begin, begin + count) of `warp`.
  void clear(const WarpCapture& warp);
  void add_lane(uint32_t lane, uint32_t segment_begin, uint32_t segment_count);

  /// The group to run next; lanes == 0 when every lane waits at a trace or has finished.
  LaneGroup next_group() const;
  /// The group has run: its lanes move on.
  void advance(const LaneGroup& group);

  /// Lanes stopped at a TraceRay, and a lane's ray (index into WarpCapture::rays).
  LaneMask tracing() const { return tracing_; }
  uint32_t ray_of(uint32_t lane) const { return cursors_[lane].ray; }
  void resume_traced() { runnable_ |= unfinished(tracing_), tracing_ = 0; }

  /// Lines a group's loads or stores touch, each memory instruction coalesced by itself.
  std::vector<LineRequest> record_lines(const LaneGroup& group, uint32_t line_bytes) const;
  std::vector<LineRequest> data_lines(const LaneGroup& group, AccessKind kind, uint32_t line_bytes) const;
  /// Calls function(access) for every store of the group: access by access, lane by lane.
  template <class Function>
  void for_each_store(const LaneGroup& group, Function&& function) const;

 private:
  struct Cursor {
    uint32_t segment = 0, end = 0;
    uint32_t ray = 0;
  };
  const Segment& segment(uint32_t lane) const { return warp_->segments[cursors_[lane].segment]; }
  LaneMask unfinished(LaneMask lanes) const;
  LaneMask deepest() const;
  void join(LaneGroup& group, uint32_t lane) const;
  template <class Function>
  void for_each_access(const LaneGroup& group, Function&& function) const;

  const WarpCapture* warp_ = nullptr;
  Cursor cursors_[max_warp_size];
  LaneMask runnable_ = 0, tracing_ = 0;
};

/// Bytes of a shader record that a call reads: its shader identifier.
inline constexpr uint32_t shader_record_bytes = 32;

// Calls function(instruction, access): accesses with the same index in their lanes are one instruction.
template <class Function>
void Simt::for_each_access(const LaneGroup& group, Function&& function) const {
  uint32_t most = 0;
  for_each_lane(group.lanes, [&](uint32_t lane) { most = std::max(most, segment(lane).access_count); });
  for (uint32_t i = 0; i < most; ++i)
    for_each_lane(group.lanes, [&](uint32_t lane) {
      if (i < segment(lane).access_count) function(i, warp_->accesses[segment(lane).access_begin + i]);
    });
}

template <class Function>
void Simt::for_each_store(const LaneGroup& group, Function&& function) const {
  for_each_access(group, [&](uint32_t, const MemoryAccess& access) {
    if (access.kind == static_cast<uint32_t>(AccessKind::store)) function(access);
  });
}

}  // namespace rayloom::hwmodel
