#include <rayloom/hwmodel/rt_core.h>

#include <algorithm>

namespace rayloom::hwmodel {

const char* state_name(RaySlotState state) {
  constexpr const char* names[] = {"free",         "no_ray",  "load_ray",      "wait_schedule", "issue",
                                   "wait_l1",      "wait_l2", "wait_dram",     "wait_mshr",     "wait_port",
                                   "wait_box",     "in_box",  "wait_triangle", "in_triangle",   "wait_transform",
                                   "in_transform", "pop",     "wait_callback", "wait_siblings", "wait_return"};
  return names[static_cast<size_t>(state)];
}

RtCore::RtCore(Engine& engine, uint32_t sm, const Config& config, L1Cache& l1, uint32_t warp_size)
    : Component(engine, "RT core " + std::to_string(sm)),
      config_(config),
      l1_(l1),
      warp_size_(warp_size),
      entries_(config.warp_entries) {
  for (Entry& entry : entries_) entry.rays = std::vector<Ray>(warp_size);
}

void RtCore::submit(uint32_t slot, const Capture& capture, uint64_t warp, LaneMask lanes, const uint32_t* rays) {
  Trace trace{slot, &capture, warp, lanes, {}};
  for_each_lane(lanes, [&](uint32_t lane) { trace.rays[lane] = rays[lane]; });
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [](const Entry& e) { return !e.used; });
  if (entry == entries_.end()) {
    waiting_.push_back(trace);
  } else {
    begin(static_cast<uint32_t>(entry - entries_.begin()), trace);
  }
}

// The rays of a trace move into a free entry.
void RtCore::begin(uint32_t index, const Trace& trace) {
  Entry& entry = entries_[index];
  const uint32_t rays = lane_count(trace.lanes);
  stats_.slots[RaySlotState::free] += (now() - entry.free_since) * warp_size_;
  entry.used = true;
  entry.trace = trace;
  entry.begun = now();
  entry.ready = 0;
  entry.unfinished = rays;
  age_.push_back(index);
  count_occupied(now());
  occupied_ += rays;
  stats_.rays += rays;
  ++stats_.warps;
  client_->trace_accepted(trace.slot);
  const uint32_t bytes = rays * config_.ray_bytes;
  const Cycle cycles = (bytes + config_.accept_bytes_per_cycle - 1) / config_.accept_bytes_per_cycle;
  schedule(accept_port_.reserve(now(), cycles) + cycles, *this, EventKind::entry_loaded, index);
}

void RtCore::handle(const Event& event) {
  switch (event.kind) {
    case EventKind::entry_loaded:
      return entry_loaded(static_cast<uint32_t>(event.a));
    case EventKind::schedule:
      return schedule_fetch();
    case EventKind::fetch_issue:
      return issue_fetch(static_cast<uint32_t>(event.a));
    case EventKind::fetch_returned:
      return fetch_returned(event);
    case EventKind::ray_tested: {
      Ray& ray = entries_[event.b].rays[event.c];
      ray.machine.complete();
      return proceed(event.b, event.c);
    }
    case EventKind::ray_popped:
      return take_step(event.b, event.c);
    case EventKind::callback_returned: {
      Ray& ray = entries_[event.b].rays[event.c];
      charge(ray, RaySlotState::wait_callback, now());
      ray.machine.decide();
      return proceed(event.b, event.c);
    }
    case EventKind::entry_returned:
      return entry_returned(static_cast<uint32_t>(event.a));
    default:
      break;
  }
}

void RtCore::entry_loaded(uint32_t index) {
  Entry& entry = entries_[index];
  for_each_lane(entry.trace.lanes, [&](uint32_t lane) {
    Ray& ray = entry.rays[lane];
    ray.since = entry.begun;
    ray.done = false;
    charge(ray, RaySlotState::load_ray, now());
    ray.machine.start(*entry.trace.capture, entry.trace.warp, entry.trace.rays[lane]);
  });
  for_each_lane(entry.trace.lanes, [&](uint32_t lane) { proceed(index, lane); });
}

// A ray asks its own stack what comes next.
void RtCore::proceed(uint32_t index, uint32_t lane) {
  Ray& ray = entries_[index].rays[lane];
  ray.step = ray.machine.next();
  while (ray.step.kind == RayStep::Kind::candidate && !ray.machine.candidate_runs_shader()) {
    ray.machine.decide();
    ray.step = ray.machine.next();
  }
  if (ray.step.culled_pops == 0) return take_step(index, lane);
  stats_.culled_pops += ray.step.culled_pops;
  charge(ray, RaySlotState::pop, now() + Cycle{ray.step.culled_pops} * config_.pop_cycles);
  schedule(ray.since, *this, EventKind::ray_popped, 0, index, lane);
}

void RtCore::take_step(uint32_t index, uint32_t lane) {
  Entry& entry = entries_[index];
  switch (entry.rays[lane].step.kind) {
    case RayStep::Kind::candidate:
      return ask_shader(index, lane);
    case RayStep::Kind::done:
      return finish_ray(index, lane);
    default:
      break;
  }
  entry.ready |= LaneMask{1} << lane;
  ++stats_.fetches_wanted;
  wake_scheduler();
}

void RtCore::wake_scheduler() {
  if (tick_scheduled_) return;
  tick_scheduled_ = true;
  schedule(std::max(now(), fetch_port_.next_free()), *this, EventKind::schedule);
}

// The oldest (or next in turn) entry with a ready ray; entries_.size() when there is none.
uint32_t RtCore::pick_entry() const {
  const auto has_ready = [&](uint32_t index) { return entries_[index].ready != 0; };
  if (config_.scheduler == oldest) {
    const auto found = std::find_if(age_.begin(), age_.end(), has_ready);
    return found == age_.end() ? static_cast<uint32_t>(entries_.size()) : *found;
  }
  const auto count = static_cast<uint32_t>(entries_.size());
  for (uint32_t i = 1; i <= count; ++i)
    if (has_ready((last_picked_ + i) % count)) return (last_picked_ + i) % count;
  return count;
}

// One clock of the scheduler: one address, and every ray of the warp that wants it.
void RtCore::schedule_fetch() {
  tick_scheduled_ = false;
  const uint32_t picked = pick_entry();
  if (picked == entries_.size()) return;
  last_picked_ = picked;
  Entry& entry = entries_[picked];
  const auto leader = static_cast<uint32_t>(__builtin_ctzll(entry.ready));
  LaneMask sharers = 0;
  for_each_lane(entry.ready, [&](uint32_t lane) {
    if (entry.rays[lane].step.address == entry.rays[leader].step.address) sharers |= LaneMask{1} << lane;
  });
  entry.ready &= ~sharers;
  start_fetch(picked, sharers);
  if (pick_entry() != entries_.size()) wake_scheduler();
}

uint32_t RtCore::new_fetch() {
  if (free_fetches_.empty()) {
    fetches_.emplace_back();
    return static_cast<uint32_t>(fetches_.size() - 1);
  }
  const uint32_t token = free_fetches_.back();
  free_fetches_.pop_back();
  return token;
}

void RtCore::start_fetch(uint32_t index, LaneMask lanes) {
  Entry& entry = entries_[index];
  const RayStep& step = entry.rays[__builtin_ctzll(lanes)].step;
  const uint32_t token = new_fetch();
  const uint32_t beats = (step.bytes + config_.fetch_bytes_per_cycle - 1) / config_.fetch_bytes_per_cycle;
  fetches_[token] = {index, lanes, step.address, step.bytes, step.request_class, beats};
  for_each_lane(lanes, [&](uint32_t lane) {
    charge(entry.rays[lane], RaySlotState::wait_schedule, now());
    charge(entry.rays[lane], RaySlotState::issue, now() + config_.schedule_latency);
  });
  fetch_port_.reserve(now(), beats);
  ++stats_.fetches;
  schedule(now() + config_.schedule_latency, *this, EventKind::fetch_issue, token);
}

void RtCore::issue_fetch(uint32_t token) {
  Fetch& fetch = fetches_[token];
  lines_.clear();
  add_lines(lines_, fetch.address, fetch.bytes, l1_.line_bytes());
  const auto lines = static_cast<uint32_t>(lines_.size());
  // The lines themselves come one a clock; only what the port needs beyond that is added when they are there.
  fetch.extra_beats = fetch.extra_beats > lines ? fetch.extra_beats - lines : 0;
  l1_.load(lines_, fetch.request_class, *this, EventKind::fetch_returned, token);
}

void RtCore::fetch_returned(const Event& event) {
  const Fetch fetch = fetches_[event.a];
  free_fetches_.push_back(static_cast<uint32_t>(event.a));
  constexpr RaySlotState by_level[] = {RaySlotState::wait_l1, RaySlotState::wait_l2, RaySlotState::wait_dram};
  for_each_lane(fetch.lanes, [&](uint32_t lane) {
    Ray& ray = entries_[fetch.entry].rays[lane];
    charge(ray, RaySlotState::wait_mshr, ray.since + event.b);
    charge(ray, by_level[event.detail], now());
    charge(ray, RaySlotState::wait_port, now() + fetch.extra_beats);
    enter_pipe(fetch.entry, lane, now() + fetch.extra_beats);
  });
}

// The fetched bytes go through the unit that tests them.
void RtCore::enter_pipe(uint32_t index, uint32_t lane, Cycle ready) {
  Ray& ray = entries_[index].rays[lane];
  const RayWork work = ray.machine.work();
  Cycle start = ready, done = ready;
  switch (work.unit) {
    case RayWork::Unit::box: {
      const Cycle busy = Cycle{(work.tests + config_.box_width - 1) / config_.box_width} * config_.box_interval;
      start = box_pipe_.reserve(ready, busy);
      done = start + busy - config_.box_interval + config_.box_latency;
      charge(ray, RaySlotState::wait_box, start);
      charge(ray, RaySlotState::in_box, done);
      stats_.box_tests += work.tests;
      ++(ray.step.kind == RayStep::Kind::node ? stats_.nodes : stats_.procedural_leaves);
      break;
    }
    case RayWork::Unit::triangle: {
      const Cycle busy = (work.tests + config_.triangle_rate - 1) / config_.triangle_rate;
      start = triangle_pipe_.reserve(ready, busy);
      done = start + busy - 1 + config_.triangle_latency;
      charge(ray, RaySlotState::wait_triangle, start);
      charge(ray, RaySlotState::in_triangle, done);
      stats_.triangle_tests += work.tests;
      ++stats_.triangle_leaves;
      break;
    }
    case RayWork::Unit::transform:
      start = transform_pipe_.reserve(ready, config_.transform_interval);
      done = start + config_.transform_latency;
      charge(ray, RaySlotState::wait_transform, start);
      charge(ray, RaySlotState::in_transform, done);
      ++stats_.instances;
      break;
    case RayWork::Unit::none:
      ++stats_.instances;
      break;
  }
  schedule(done, *this, EventKind::ray_tested, 0, index, lane);
}

void RtCore::ask_shader(uint32_t index, uint32_t lane) {
  const Entry& entry = entries_[index];
  ++stats_.callbacks;
  schedule(now() + config_.callback_latency, *sm_, EventKind::callback_arrives,
           uint64_t{entry.rays[lane].machine.candidate_index()} << 32 | entry.trace.slot, index, lane);
}

void RtCore::answer_callback(uint32_t index, uint32_t lane) {
  schedule(now() + config_.callback_latency, *this, EventKind::callback_returned, 0, index, lane);
}

void RtCore::finish_ray(uint32_t index, uint32_t lane) {
  Entry& entry = entries_[index];
  entry.rays[lane].done = true;
  client_->ray_done(entry.trace.slot, lane, now() - entry.begun);
  if (--entry.unfinished == 0) return_entry(index);
}

void RtCore::return_entry(uint32_t index) {
  const Cycle start = return_port_.reserve(now(), config_.return_interval);
  schedule(start + config_.return_latency, *this, EventKind::entry_returned, index);
  Entry& entry = entries_[index];
  for_each_lane(entry.trace.lanes,
                [&](uint32_t lane) { charge(entry.rays[lane], RaySlotState::wait_siblings, now()); });
}

void RtCore::entry_returned(uint32_t index) {
  Entry& entry = entries_[index];
  const uint32_t rays = lane_count(entry.trace.lanes);
  for_each_lane(entry.trace.lanes, [&](uint32_t lane) { charge(entry.rays[lane], RaySlotState::wait_return, now()); });
  stats_.slots[RaySlotState::no_ray] += (now() - entry.begun) * (warp_size_ - rays);
  stats_.ray_residence += (now() - entry.begun) * rays;
  stats_.rays_returned += rays;
  count_occupied(now());
  occupied_ -= rays;
  entry.used = false;
  entry.free_since = now();
  age_.erase(std::find(age_.begin(), age_.end(), index));
  schedule(now(), *sm_, EventKind::trace_returned, entry.trace.slot);
  if (waiting_.empty()) return;
  const Trace trace = waiting_.front();
  waiting_.pop_front();
  begin(index, trace);
}

// The ray's slot was, or will be, in `state` until `until`.
void RtCore::charge(Ray& ray, RaySlotState state, Cycle until) {
  stats_.slots[state] += until - ray.since;
  ray.since = until;
}

void RtCore::count_occupied(Cycle until) {
  stats_.occupied_slot_cycles += occupied_ * (until - occupied_since_);
  occupied_since_ = until;
}

void RtCore::finish(Cycle cycles) {
  for (Entry& entry : entries_) stats_.slots[RaySlotState::free] += (cycles - entry.free_since) * warp_size_;
  count_occupied(cycles);
  stats_.port_busy = fetch_port_.busy();
  stats_.box_busy = box_pipe_.busy();
  stats_.triangle_busy = triangle_pipe_.busy();
  stats_.transform_busy = transform_pipe_.busy();
  stats_.accept_busy = accept_port_.busy();
  stats_.return_busy = return_port_.busy();
}

void RtCore::describe_waiting(std::vector<std::string>& lines) const {
  for (size_t i = 0; i < entries_.size(); ++i) {
    if (!entries_[i].used) continue;
    for_each_lane(entries_[i].trace.lanes, [&](uint32_t lane) {
      const Ray& ray = entries_[i].rays[lane];
      if (ray.done) return;
      lines.push_back(
          name() + ", entry " + std::to_string(i) + ", lane " + std::to_string(lane) + " waits for " +
          (ray.step.kind == RayStep::Kind::candidate ? sm_->name() + " to run a shader" : l1_.name() + " or a pipe"));
    });
  }
  for (const Trace& trace : waiting_)
    lines.push_back(sm_->name() + ", warp slot " + std::to_string(trace.slot) + " waits for an entry of " + name());
}

}  // namespace rayloom::hwmodel
