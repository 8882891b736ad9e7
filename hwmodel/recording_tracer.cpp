#include <rayloom/accel/structure.h>
#include <rayloom/accel/walk.h>
#include <rayloom/hwmodel/lane_recorder.h>
#include <rayloom/hwmodel/ray_events.h>
#include <rayloom/hwmodel/recording_tracer.h>

#include <algorithm>
#include <utility>

namespace rayloom::hwmodel {

namespace {

class WarpRecorder : public WarpTracer {
 public:
  explicit WarpRecorder(const LaunchHeader& header)
      : header_(header), lanes_(header.warp_size, LaneRecorder(header.shaders)), callback_(header.shaders) {}

  void trace(std::span<TraceCall> calls) override {
    for (TraceCall& call : calls) record_ray(call);
  }
  void begin_shader(uint32_t lane, uint32_t shader, uint64_t record_address) override {
    recorder(lane).begin_shader(shader, record_address);
  }
  void end_shader(uint32_t lane) override { recorder(lane).end_shader(); }
  void access(uint32_t lane, AccessKind kind, uint64_t address, uint32_t bytes, const void* data) override;
  void branch(uint32_t lane, uint32_t signature) override { recorder(lane).branch(signature); }
  void call_shader(uint32_t lane, uint32_t) override { recorder(lane).call(); }

  // Sink of RayEventVisitor.
  void event(const RayEvent& event);
  void candidate(const accel::Candidate& candidate, const accel::Verdict& verdict);

  /// Joins the lanes; nothing may be recorded afterwards.
  WarpCapture finish();
  const std::vector<StructureRange>& structures() const { return structures_; }

 private:
  /// Where a shader's doings go: during a ray's walk to the callback's own list.
  LaneRecorder& recorder(uint32_t lane) { return walking_ ? callback_ : lanes_[lane]; }
  void record_ray(TraceCall& call);
  void note_structure(uint64_t address);
  uint32_t append(const LaneRecorder& recorder);

  const LaunchHeader& header_;
  std::vector<LaneRecorder> lanes_;
  LaneRecorder callback_;
  bool walking_ = false;
  std::vector<StructureRange> structures_;
  WarpCapture capture_;
};

void WarpRecorder::access(uint32_t lane, AccessKind kind, uint64_t address, uint32_t bytes, const void* data) {
  MemoryAccess access;
  access.address = address;
  access.bytes = bytes & 0xFFFFFF;
  access.kind = static_cast<uint8_t>(kind);
  access.store_data = static_cast<uint32_t>(capture_.store_data.size());
  if (kind == AccessKind::store) {
    const auto* first = static_cast<const std::byte*>(data);
    capture_.store_data.insert(capture_.store_data.end(), first, first + bytes);
  }
  recorder(lane).access(access);
}

void WarpRecorder::record_ray(TraceCall& call) {
  LaneRecorder& lane = lanes_[call.lane];
  const auto index = static_cast<uint32_t>(capture_.rays.size());
  RayCapture& ray = capture_.rays.emplace_back();
  ray.ray = call.request.ray;
  ray.structure_address = call.structure_address;
  ray.ray_flags = call.request.ray_flags;
  ray.instance_mask = static_cast<uint8_t>(call.request.instance_mask);
  ray.asks_candidates = call.request.candidate != nullptr;
  ray.lane = static_cast<uint16_t>(call.lane);
  ray.depth = lane.depth();
  ray.event_begin = static_cast<uint32_t>(capture_.events.size());
  ray.candidate_begin = static_cast<uint32_t>(capture_.candidates.size());
  lane.trace(index);

  accel::TraceRequest request = call.request;
  request.structure = call.structure_address ? header_.addresses.host(call.structure_address) : nullptr;
  note_structure(call.structure_address);
  RayEventVisitor visitor(header_.addresses, *this);
  walking_ = true;
  call.hit = accel::walk(header_.addresses, request, visitor);
  walking_ = false;
  capture_.rays[index].hit = call.hit;
  capture_.rays[index].event_count = static_cast<uint32_t>(capture_.events.size()) - capture_.rays[index].event_begin;
}

void WarpRecorder::note_structure(uint64_t address) {
  if (address == 0 || (!structures_.empty() && structures_.back().address == address)) return;
  const accel::StructureHeader& header = accel::header_of(header_.addresses.host(address));
  structures_.push_back({address, header.bytes, header.kind == accel::StructureKind::instances});
}

void WarpRecorder::event(const RayEvent& event) {
  capture_.events.push_back(event);
  if (event.kind != RayEventKind::enter_instance) return;
  const std::byte* record = header_.addresses.host(event.address);
  note_structure(reinterpret_cast<const accel::InstanceRecord*>(record)->bottom_level_address);
}

void WarpRecorder::candidate(const accel::Candidate& candidate, const accel::Verdict& verdict) {
  const auto index = static_cast<uint32_t>(capture_.candidates.size());
  event({0, index, RayEventKind::candidate, 0, digest_of(verdict)});
  CandidateCapture captured{candidate.type,
                            candidate.opaque,
                            candidate.instance_index,
                            candidate.geometry_index,
                            candidate.primitive_index,
                            candidate.t,
                            candidate.t_current,
                            0,
                            0,
                            verdict};
  // Counts from the first callback segment; finish() moves it behind those of the lanes.
  const auto recorded = static_cast<uint32_t>(callback_.segments().size());
  if (!capture_.candidates.empty()) {
    const CandidateCapture& last = capture_.candidates.back();
    captured.segment_begin = last.segment_begin + last.segment_count;
  }
  captured.segment_count = recorded - captured.segment_begin;
  capture_.candidates.push_back(captured);
}

// Returns the index of the recorder's first segment.
uint32_t WarpRecorder::append(const LaneRecorder& recorder) {
  const auto first = static_cast<uint32_t>(capture_.segments.size());
  const auto first_access = static_cast<uint32_t>(capture_.accesses.size());
  for (Segment segment : recorder.segments()) {
    segment.access_begin += first_access;
    capture_.segments.push_back(segment);
  }
  capture_.accesses.insert(capture_.accesses.end(), recorder.accesses().begin(), recorder.accesses().end());
  return first;
}

WarpCapture WarpRecorder::finish() {
  for (const LaneRecorder& lane : lanes_) {
    const uint32_t first = append(lane);
    capture_.lanes.push_back({first, static_cast<uint32_t>(lane.segments().size())});
  }
  const uint32_t first = append(callback_);
  for (CandidateCapture& candidate : capture_.candidates) candidate.segment_begin += first;
  return std::move(capture_);
}

void sort_unique(std::vector<StructureRange>& ranges) {
  std::sort(ranges.begin(), ranges.end(),
            [](const StructureRange& a, const StructureRange& b) { return a.address < b.address; });
  const auto same = [](const StructureRange& a, const StructureRange& b) { return a.address == b.address; };
  ranges.erase(std::unique(ranges.begin(), ranges.end(), same), ranges.end());
}

}  // namespace

void RecordingTracer::begin_dispatch(const DispatchInfo& info) {
  Capture& capture = captures_.emplace_back();
  capture.header = {info.width, info.height,   info.depth, info.warp_size, {info.shaders.begin(), info.shaders.end()},
                    {},         info.addresses};
  capture.warps.resize(info.warp_count);
}

std::unique_ptr<WarpTracer> RecordingTracer::begin_warp(uint64_t) {
  return std::make_unique<WarpRecorder>(captures_.back().header);
}

void RecordingTracer::end_warp(uint64_t warp, std::unique_ptr<WarpTracer> tracer) {
  auto& recorder = static_cast<WarpRecorder&>(*tracer);
  captures_.back().warps[warp] = recorder.finish();
  std::vector<StructureRange> seen = recorder.structures();
  sort_unique(seen);
  const std::lock_guard lock(structures_mutex_);
  structures_.insert(structures_.end(), seen.begin(), seen.end());
  sort_unique(structures_);
}

void RecordingTracer::end_dispatch() { captures_.back().header.structures = std::exchange(structures_, {}); }

}  // namespace rayloom::hwmodel
