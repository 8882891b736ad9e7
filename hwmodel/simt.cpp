#include <rayloom/hwmodel/simt.h>

#include <algorithm>

namespace rayloom::hwmodel {

void Simt::clear(const WarpCapture& warp) {
  warp_ = &warp;
  runnable_ = tracing_ = 0;
}

void Simt::add_lane(uint32_t lane, uint32_t segment_begin, uint32_t segment_count) {
  cursors_[lane] = {segment_begin, segment_begin + segment_count, 0};
  if (segment_count > 0) runnable_ |= LaneMask{1} << lane;
}

LaneMask Simt::unfinished(LaneMask lanes) const {
  LaneMask result = 0;
  for_each_lane(lanes, [&](uint32_t lane) {
    if (cursors_[lane].segment < cursors_[lane].end) result |= LaneMask{1} << lane;
  });
  return result;
}

LaneMask Simt::deepest() const {
  uint16_t depth = 0;
  LaneMask lanes = 0;
  for_each_lane(runnable_, [&](uint32_t lane) {
    const uint16_t lane_depth = segment(lane).depth;
    if (lane_depth > depth) depth = lane_depth, lanes = 0;
    if (lane_depth == depth) lanes |= LaneMask{1} << lane;
  });
  return lanes;
}

void Simt::join(LaneGroup& group, uint32_t lane) const {
  const Segment& s = segment(lane);
  group.lanes |= LaneMask{1} << lane;
  group.alu = std::max(group.alu, s.alu);
  group.special = std::max(group.special, s.special);
  group.lane_operations += uint64_t{s.alu} + s.special;
  group.invocations += s.begins;
  group.accesses = std::max(group.accesses, s.access_count + (s.record != 0));
}

LaneGroup Simt::next_group() const {
  LaneGroup group;
  const LaneMask candidates = deepest();
  if (!candidates) return group;
  const Segment& leader = segment(static_cast<uint32_t>(__builtin_ctzll(candidates)));
  group.shader = leader.shader;
  for_each_lane(candidates, [&](uint32_t lane) {
    const Segment& s = segment(lane);
    if (s.shader == leader.shader && s.signature == leader.signature) join(group, lane);
  });
  return group;
}

void Simt::advance(const LaneGroup& group) {
  for_each_lane(group.lanes, [&](uint32_t lane) {
    const LaneMask bit = LaneMask{1} << lane;
    Cursor& cursor = cursors_[lane];
    const Segment& done = warp_->segments[cursor.segment++];
    if (done.end == SegmentEnd::trace) {
      cursor.ray = done.ray;
      tracing_ |= bit;
      runnable_ &= ~bit;
    } else if (cursor.segment == cursor.end) {
      runnable_ &= ~bit;
    }
  });
}

std::vector<LineRequest> Simt::record_lines(const LaneGroup& group, uint32_t line_bytes) const {
  std::vector<LineRequest> lines;
  for_each_lane(group.lanes, [&](uint32_t lane) {
    if (segment(lane).record) add_lines(lines, segment(lane).record, shader_record_bytes, line_bytes);
  });
  return lines;
}

std::vector<LineRequest> Simt::data_lines(const LaneGroup& group, AccessKind kind, uint32_t line_bytes) const {
  std::vector<LineRequest> all, one;
  uint32_t instruction = 0;
  const auto finish_instruction = [&] {
    all.insert(all.end(), one.begin(), one.end());
    one.clear();
  };
  for_each_access(group, [&](uint32_t i, const MemoryAccess& access) {
    if (i != instruction) finish_instruction(), instruction = i;
    if (access.kind == static_cast<uint32_t>(kind)) add_lines(one, access.address, access.bytes, line_bytes);
  });
  finish_instruction();
  return all;
}

}  // namespace rayloom::hwmodel
