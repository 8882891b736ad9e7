#include <rayloom/base/hash.h>
#include <rayloom/hwmodel/lane_recorder.h>

namespace rayloom::hwmodel {

void LaneRecorder::begin_shader(uint32_t shader, uint64_t record_address) {
  call();
  frames_.push_back(shader);
  Segment& segment = open();
  segment.record = record_address;
  segment.begins = true;
  if (shader >= shaders_.size()) return;
  segment.alu = shaders_[shader].cost.alu;
  segment.special = shaders_[shader].cost.special;
}

void LaneRecorder::end_shader() {
  close(SegmentEnd::finish);
  if (!frames_.empty()) frames_.pop_back();
}

void LaneRecorder::access(const MemoryAccess& access) {
  ++open().access_count;
  accesses_.push_back(access);
}

void LaneRecorder::branch(uint32_t signature) {
  Segment& segment = open();
  segment.signature = hash64(segment.signature, signature);
}

void LaneRecorder::trace(uint32_t ray) {
  open().ray = ray;
  close(SegmentEnd::trace);
}

void LaneRecorder::call() { close(SegmentEnd::call); }

// The segment being written; begins the next stretch of the running shader when there is none.
Segment& LaneRecorder::open() {
  if (open_) return segments_.back();
  open_ = true;
  Segment& segment = segments_.emplace_back();
  segment.shader = frames_.empty() ? 0 : frames_.back();
  segment.depth = depth();
  segment.access_begin = static_cast<uint32_t>(accesses_.size());
  return segment;
}

void LaneRecorder::close(SegmentEnd end) {
  if (!open_) return;
  segments_.back().end = end;
  open_ = false;
}

}  // namespace rayloom::hwmodel
