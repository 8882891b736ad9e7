#include <rayloom/hwmodel/sm.h>

#include <algorithm>

namespace rayloom::hwmodel {

const char* state_name(WarpSlotState state) {
  constexpr const char* names[] = {"before_first_warp", "between_warps", "after_last_warp", "wait_issue",
                                   "issuing",           "dependency",    "memory_l1",       "memory_l2",
                                   "memory_dram",       "memory_mshr",   "rt_buffer_full",  "rt_trace"};
  return names[static_cast<size_t>(state)];
}

const char* state_name(IssueState state) {
  constexpr const char* names[] = {"issuing", "dependency", "memory", "rt_buffer_full", "rt_trace", "no_warp"};
  return names[static_cast<size_t>(state)];
}

Sm::Sm(Engine& engine, uint32_t index, const Config& config, L1Cache& l1, RtCore& rt_core, ShadowMemory& memory,
       uint32_t warp_size)
    : Component(engine, "SM " + std::to_string(index)),
      config_(config),
      l1_(l1),
      rt_core_(rt_core),
      memory_(memory),
      index_(index),
      warp_size_(warp_size),
      slots_(config.warp_slots),
      sub_partitions_(config.sub_partitions) {
  for (uint32_t i = 0; i < config.warp_slots; ++i) {
    slots_[i].busy.resize(warp_size);
    ++sub_partition_of(i).count[static_cast<size_t>(WarpSlotState::before_first_warp)];
  }
}

void Sm::handle(const Event& event) {
  const auto slot = static_cast<uint32_t>(event.a);
  switch (event.kind) {
    case EventKind::warp_arrives:
      return warp_arrives(event.b, event.a);
    case EventKind::issue_done:
      return issue_done(slot, now() + event.b);
    case EventKind::warp_ready:
      return warp_ready(slot);
    case EventKind::loads_returned:
      return loads_returned(event);
    case EventKind::trace_returned:
      return trace_returned(slot);
    case EventKind::callback_arrives:
      return callback_arrives(event);
    default:
      break;
  }
}

// The dispatcher never sends more warps than there are slots.
void Sm::warp_arrives(uint32_t launch, uint64_t warp) {
  const auto free = std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return !s.used; });
  const auto index = static_cast<uint32_t>(free - slots_.begin());
  Slot& slot = *free;
  count_occupied();
  ++occupied_;
  charge(index, slot.state, now());
  slot.used = true;
  slot.launch = launch;
  slot.warp = warp;
  slot.begun = now();
  std::fill(slot.busy.begin(), slot.busy.end(), 0);
  const WarpCapture& capture = warp_of(slot);
  slot.lanes.clear(capture);
  for (uint32_t lane = 0; lane < capture.lanes.size(); ++lane)
    slot.lanes.add_lane(lane, capture.lanes[lane].segment_begin, capture.lanes[lane].segment_count);
  ++stats_.warps;
  run_next_group(index);
}

void Sm::run_next_group(uint32_t index) {
  Slot& slot = slots_[index];
  Simt& simt = simt_of(slot);
  for (;;) {
    slot.group = simt.next_group();
    if (!slot.group.lanes) break;
    count_group(slot);
    slot.left = work_of(slot.group);
    if (!slot.left.empty()) return want_issue(index);
    simt.advance(slot.group);
  }
  if (slot.in_callback) return end_callbacks(index);
  if (simt.tracing()) return begin_trace(index);
  warp_ends(index);
}

Sm::Work Sm::work_of(const LaneGroup& group) const {
  const uint32_t call = group.invocations > 0 ? config_.shader_call_operations : 0;
  return {group.alu + call, group.special, group.accesses};
}

void Sm::count_group(const Slot& slot) {
  const LaneGroup& group = slot.group;
  if (shaders_.size() <= slot.launch) shaders_.resize(slot.launch + 1);
  auto& shaders = shaders_[slot.launch];
  if (shaders.size() <= group.shader) shaders.resize(group.shader + 1);
  accumulate(shaders[group.shader],
             ShaderStats{group.invocations, uint64_t{group.alu} + group.special, group.lane_operations});
  stats_.warp_operations += uint64_t{group.alu} + group.special;
  stats_.lane_operations += group.lane_operations;
  stats_.call_operations += group.invocations > 0 ? config_.shader_call_operations : 0;
  stats_.memory_instructions += group.accesses;
}

void Sm::want_issue(uint32_t index) {
  set_state(index, WarpSlotState::wait_issue);
  SubPartition& sub_partition = sub_partition_of(index);
  sub_partition.ready.push_back(index);
  try_issue(sub_partition);
}

Sm::Bundle Sm::take_bundle(Work& work) const {
  uint32_t& instructions = work.plain ? work.plain : work.special ? work.special : work.memory;
  const Cycle interval = work.plain ? 1 : work.special ? config_.special_interval : config_.memory_interval;
  const Cycle taken = std::min(instructions, config_.bundle);
  instructions -= static_cast<uint32_t>(taken);
  return {taken * interval, taken * std::max<Cycle>(interval, config_.dependency_latency)};
}

void Sm::try_issue(SubPartition& sub_partition) {
  if (sub_partition.issuing || sub_partition.ready.empty()) return;
  const uint32_t index = sub_partition.ready.front();
  sub_partition.ready.pop_front();
  set_state(index, WarpSlotState::issuing);
  sub_partition.issuing = true;
  const Bundle bundle = take_bundle(slots_[index].left);
  stats_.issued_cycles += bundle.issue;
  schedule(now() + bundle.issue, *this, EventKind::issue_done, index,
           static_cast<uint32_t>(bundle.latency - bundle.issue));
}

void Sm::issue_done(uint32_t index, Cycle ready) {
  SubPartition& sub_partition = sub_partition_of(index);
  charge_issue_slot(sub_partition);
  sub_partition.issuing = false;
  set_state(index, WarpSlotState::dependency);
  schedule(ready, *this, EventKind::warp_ready, index);
  try_issue(sub_partition);
}

void Sm::warp_ready(uint32_t index) {
  Slot& slot = slots_[index];
  if (!slot.left.empty()) return want_issue(index);
  if (slot.entering_trace) return submit_trace(index);
  access_memory(index);
}

// Stores leave at once and nobody waits for them; the group is done when its loads are back.
void Sm::access_memory(uint32_t index) {
  Slot& slot = slots_[index];
  if (slot.group.accesses == 0) return group_done(index);
  const Simt& simt = simt_of(slot);
  apply_stores(slot);
  l1_.store(simt.data_lines(slot.group, AccessKind::store, l1_.line_bytes()), RequestClass::shader_data);
  slot.loads_pending = 0;
  load(index, simt.record_lines(slot.group, l1_.line_bytes()), RequestClass::shader_record);
  load(index, simt.data_lines(slot.group, AccessKind::load, l1_.line_bytes()), RequestClass::shader_data);
  if (slot.loads_pending == 0) return group_done(index);
  set_state(index, WarpSlotState::memory_l1);
}

void Sm::load(uint32_t index, const std::vector<LineRequest>& lines, RequestClass request_class) {
  if (lines.empty()) return;
  ++slots_[index].loads_pending;
  l1_.load(lines, request_class, *this, EventKind::loads_returned, index);
}

void Sm::apply_stores(const Slot& slot) {
  const WarpCapture& warp = warp_of(slot);
  const Simt& simt = slot.in_callback ? slot.callback_lanes : slot.lanes;
  simt.for_each_store(slot.group, [&](const MemoryAccess& access) {
    memory_.store(access.address, std::span(warp.store_data).subspan(access.store_data, access.bytes));
  });
}

void Sm::loads_returned(const Event& event) {
  const auto index = static_cast<uint32_t>(event.a);
  if (--slots_[index].loads_pending > 0) return;
  constexpr WarpSlotState by_level[] = {WarpSlotState::memory_l1, WarpSlotState::memory_l2, WarpSlotState::memory_dram};
  charge(index, WarpSlotState::memory_mshr, std::min(slots_[index].since + event.b, now()));
  charge(index, by_level[event.detail], now());
  group_done(index);
}

void Sm::group_done(uint32_t index) {
  charge(index, slots_[index].state, now());  // to the lanes of this group
  simt_of(slots_[index]).advance(slots_[index].group);
  run_next_group(index);
}

// Every lane has come to a TraceRay or to its end: the trace instruction issues for those that trace.
void Sm::begin_trace(uint32_t index) {
  Slot& slot = slots_[index];
  slot.entering_trace = true;
  slot.left = {config_.trace_call_operations, 0, 0};
  stats_.call_operations += config_.trace_call_operations;
  if (slot.left.empty()) return submit_trace(index);
  want_issue(index);
}

void Sm::submit_trace(uint32_t index) {
  Slot& slot = slots_[index];
  uint32_t rays[max_warp_size] = {};
  for_each_lane(slot.lanes.tracing(), [&](uint32_t lane) { rays[lane] = slot.lanes.ray_of(lane); });
  set_state(index, WarpSlotState::rt_buffer_full);
  rt_core_.submit(index, *(*launches_)[slot.launch].capture, slot.warp, slot.lanes.tracing(), rays);
}

void Sm::trace_accepted(uint32_t index) {
  set_state(index, WarpSlotState::rt_trace);
  slots_[index].entering_trace = false;
}

void Sm::ray_done(uint32_t index, uint32_t lane, Cycle cycles) { slots_[index].busy[lane] += cycles; }

void Sm::trace_returned(uint32_t index) {
  slots_[index].lanes.resume_traced();
  run_next_group(index);
}

void Sm::callback_arrives(const Event& event) {
  const auto index = static_cast<uint32_t>(event.a & 0xFFFFFFFF);
  Slot& slot = slots_[index];
  slot.asked.push_back({event.b, event.c, static_cast<uint32_t>(event.a >> 32)});
  ++stats_.callbacks;
  if (!slot.in_callback) begin_callbacks(index);
}

// The waiting warp runs the shaders of all its rays that have asked by now, as lanes of one warp.
void Sm::begin_callbacks(uint32_t index) {
  Slot& slot = slots_[index];
  const WarpCapture& warp = warp_of(slot);
  charge(index, slot.state, now());
  slot.in_callback = true;
  slot.running.swap(slot.asked);
  slot.asked.clear();
  slot.callback_lanes.clear(warp);
  for (const Callback& callback : slot.running) {
    const CandidateCapture& candidate = warp.candidates[callback.candidate];
    slot.callback_lanes.add_lane(callback.lane, candidate.segment_begin, candidate.segment_count);
  }
  ++stats_.callback_batches;
  run_next_group(index);
}

void Sm::end_callbacks(uint32_t index) {
  Slot& slot = slots_[index];
  for (const Callback& callback : slot.running) rt_core_.answer_callback(callback.entry, callback.lane);
  slot.running.clear();
  set_state(index, WarpSlotState::rt_trace);
  slot.in_callback = false;
  if (!slot.asked.empty()) begin_callbacks(index);
}

void Sm::warp_ends(uint32_t index) {
  Slot& slot = slots_[index];
  charge(index, slot.state, now());
  LaunchRun& launch = (*launches_)[slot.launch];
  const Cycle residence = now() - slot.begun;
  for (uint32_t lane = 0; lane < warp_size_; ++lane) {
    const uint64_t lane_index = slot.warp * warp_size_ + lane;
    if (lane_index >= launch.lane_cycles.size()) {
      stats_.lane_absent_cycles += residence;
      continue;
    }
    ++stats_.lanes;
    launch.lane_cycles[lane_index] += slot.busy[lane];
    stats_.lane_busy_cycles += slot.busy[lane];
    stats_.lane_idle_cycles += residence - slot.busy[lane];
  }
  stats_.warp_residence += residence;
  last_warp_end_ = now();
  count_occupied();
  --occupied_;
  set_state(index, WarpSlotState::between_warps);
  slot.used = false;
  schedule(now(), *dispatcher_, EventKind::warp_done, 0, index_);
}

void Sm::set_state(uint32_t index, WarpSlotState state) {
  Slot& slot = slots_[index];
  SubPartition& sub_partition = sub_partition_of(index);
  charge(index, slot.state, now());
  charge_issue_slot(sub_partition);
  --sub_partition.count[static_cast<size_t>(slot.state)];
  ++sub_partition.count[static_cast<size_t>(state)];
  slot.state = state;
}

void Sm::charge(uint32_t index, WarpSlotState state, Cycle until) {
  Slot& slot = slots_[index];
  const Cycle cycles = until - slot.since;
  slot.since = until;
  stats_.slots[state] += cycles;
  if (cycles == 0) return;
  for_each_lane(busy_lanes(slot), [&](uint32_t lane) { slot.busy[lane] += cycles; });
}

// Lanes at work in the present state. Rays in the RT core are counted by ray_done.
LaneMask Sm::busy_lanes(const Slot& slot) const {
  if (!slot.used || slot.in_callback || slot.state == WarpSlotState::rt_trace) return 0;
  return slot.entering_trace ? slot.lanes.tracing() : slot.group.lanes;
}

void Sm::charge_issue_slot(SubPartition& sub_partition) {
  const auto warps = [&](WarpSlotState state) { return sub_partition.count[static_cast<size_t>(state)] > 0; };
  const auto reason = [&] {
    if (sub_partition.issuing) return IssueState::issuing;
    if (warps(WarpSlotState::dependency)) return IssueState::dependency;
    if (warps(WarpSlotState::memory_l1)) return IssueState::memory;
    if (warps(WarpSlotState::rt_buffer_full)) return IssueState::rt_buffer_full;
    return warps(WarpSlotState::rt_trace) ? IssueState::rt_trace : IssueState::no_warp;
  };
  if (now() > sub_partition.since) stats_.issue[reason()] += now() - sub_partition.since;
  sub_partition.since = now();
}

void Sm::count_occupied() {
  stats_.occupied_slot_cycles += occupied_ * (now() - occupied_since_);
  occupied_since_ = now();
}

void Sm::finish(Cycle cycles) {
  for (Slot& slot : slots_) {
    stats_.slots[WarpSlotState::after_last_warp] += cycles - slot.since;
    slot.since = cycles;
  }
  for (SubPartition& sub_partition : sub_partitions_) {
    stats_.issue[IssueState::no_warp] += cycles - sub_partition.since;
    sub_partition.since = cycles;
  }
  count_occupied();
}

void Sm::describe_waiting(std::vector<std::string>& lines) const {
  for (size_t i = 0; i < slots_.size(); ++i) {
    if (!slots_[i].used) continue;
    lines.push_back(name() + ", warp slot " + std::to_string(i) + ", warp " + std::to_string(slots_[i].warp) + ": " +
                    state_name(slots_[i].state));
  }
}

}  // namespace rayloom::hwmodel
