#include <rayloom/base/error.h>
#include <rayloom/hwmodel/l2_cache.h>

#include <algorithm>
#include <utility>

namespace rayloom::hwmodel {

L2Cache::L2Cache(Engine& engine, const Config& config, const CrossbarConfig& crossbar, uint32_t line_bytes)
    : Component(engine, "L2"),
      config_(config),
      crossbar_(crossbar),
      inner_latency_(config.latency - 2 * Cycle{crossbar.latency}) {
  if (config.latency < 2 * crossbar.latency)
    throw UsageError("l2.latency: " + std::to_string(config.latency) +
                     " clocks are fewer than two crossings of crossbar.latency");
  const uint32_t sets = config.kilobytes_per_slice * 1024 / (line_bytes * config.ways);
  slices_.reserve(config.slices);
  for (uint32_t i = 0; i < config.slices; ++i) slices_.emplace_back(sets, config);
}

void L2Cache::connect(std::vector<const Component*> l1s, const Component& dram) {
  l1s_ = std::move(l1s);
  return_ports_.resize(l1s_.size());
  dram_ = &dram;
}

void L2Cache::handle(const Event& event) {
  if (event.kind == EventKind::memory_request) {
    request(MemoryMessage::from(event), event.c);
  } else {
    filled(MemoryMessage::from(event).request);
  }
}

void L2Cache::request(const MemoryMessage& message, uint32_t sm) {
  Slice& slice = slice_of(message.request.line);
  const uint32_t sectors = sector_count(message.request.sectors);
  const uint32_t cycles = (sectors * sector_bytes + config_.bytes_per_cycle - 1) / config_.bytes_per_cycle;
  const Cycle time = slice.port.reserve(now(), cycles);
  if (message.store) {
    stats_.stores[message.request_class] += sectors;
    insert(slice, message.request, true);
    return;
  }
  stats_.accesses[message.request_class] += sectors;
  ++stats_.line_accesses[message.request_class];
  if (load(slice, message, sm, time)) return;
  ++stats_.mshr_full;
  slice.blocked.push_back({message, sm, time});
}

// False when the load needs an MSHR and there is none.
bool L2Cache::load(Slice& slice, const MemoryMessage& message, uint32_t sm, Cycle time) {
  const auto& [line, sectors] = message.request;
  const SectorMask missing = sectors & ~slice.tags.lookup(line_in_slice(line));
  if (missing) {
    const auto [outcome, ask] = slice.mshrs.add(line, missing, {sm, sectors});
    if (outcome == MshrTable<Waiter>::Outcome::full) return false;
    stats_.mshr_peak = std::max<uint64_t>(stats_.mshr_peak, slice.mshrs.size());
    stats_.misses[message.request_class] += sector_count(ask);
    stats_.half_misses[message.request_class] += sector_count(missing & ~ask);
    const MemoryMessage below{{line, ask}, message.request_class, false};
    if (ask) schedule(time + inner_latency_, *dram_, EventKind::memory_request, line, below.packed());
  }
  stats_.hits[message.request_class] += sector_count(sectors & ~missing);
  if (!missing) respond(sm, message.request, time + inner_latency_, ServedBy::l2);
  return true;
}

void L2Cache::filled(const LineRequest& fill) {
  Slice& slice = slice_of(fill.line);
  insert(slice, fill, false);
  slice.mshrs.filled(fill.line, fill.sectors, [&](const Waiter& waiter) {
    respond(waiter.sm, {fill.line, waiter.sectors}, now(), ServedBy::dram);
  });
  retry_blocked(slice);
}

void L2Cache::insert(Slice& slice, const LineRequest& fill, bool dirty) {
  const auto evicted = slice.tags.fill(line_in_slice(fill.line), fill.sectors, dirty);
  if (!evicted) return;
  const uint64_t line = evicted->line * slices_.size() + fill.line % slices_.size();
  const MemoryMessage write{{line, evicted->dirty}, RequestClass::shader_data, true};
  schedule(now() + inner_latency_, *dram_, EventKind::memory_request, line, write.packed());
}

void L2Cache::respond(uint32_t sm, const LineRequest& request, Cycle time, ServedBy served_by) {
  const uint32_t bytes = sector_count(request.sectors) * sector_bytes;
  const Cycle beats = (bytes + crossbar_.bytes_per_cycle - 1) / crossbar_.bytes_per_cycle;
  const Cycle start = return_ports_[sm].reserve(time, beats);
  schedule(start + beats - 1 + crossbar_.latency, *l1s_[sm], EventKind::memory_response, request.line, request.sectors,
           0, static_cast<uint16_t>(served_by));
}

void L2Cache::retry_blocked(Slice& slice) {
  while (!slice.blocked.empty()) {
    const Blocked blocked = slice.blocked.front();
    const Cycle time = std::max(now(), blocked.since);
    if (!load(slice, blocked.message, blocked.sm, time)) return;
    stats_.mshr_wait_cycles += time - blocked.since;
    slice.blocked.pop_front();
  }
}

Cycle L2Cache::port_busy() const {
  Cycle sum = 0;
  for (const Slice& slice : slices_) sum += slice.port.busy();
  return sum;
}

void L2Cache::describe_waiting(std::vector<std::string>& lines) const {
  for (const Slice& slice : slices_) {
    for (const auto& entry : slice.mshrs.entries())
      lines.push_back("L2 waits for DRAM: line " + std::to_string(entry.line));
    for (const Blocked& blocked : slice.blocked)
      lines.push_back("L2 waits for an MSHR of its own: line " + std::to_string(blocked.message.request.line) +
                      " for L1 " + std::to_string(blocked.sm));
  }
}

}  // namespace rayloom::hwmodel
