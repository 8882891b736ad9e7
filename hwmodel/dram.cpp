#include <rayloom/base/error.h>
#include <rayloom/hwmodel/dram.h>

#include <algorithm>

namespace rayloom::hwmodel {

Dram::Dram(Engine& engine, const Config& config, uint32_t l2_latency, uint32_t core_mhz)
    : Component(engine, "DRAM"),
      config_(config),
      inner_latency_(Cycle{config.latency} - l2_latency),
      channels_(config.channels) {
  if (config.latency < l2_latency)
    throw UsageError("dram.latency: " + std::to_string(config.latency) + " clocks are fewer than l2.latency");
  const uint64_t sector_clocks = uint64_t{sector_bytes} * core_mhz * subcycles * config.channels;
  sector_subcycles_ = (sector_clocks + config.bandwidth_mb_per_second - 1) / config.bandwidth_mb_per_second;
}

// A line's sectors lie on one channel, lines alternate.
void Dram::handle(const Event& event) {
  if (event.kind == EventKind::write_done) return;
  const MemoryMessage message = MemoryMessage::from(event);
  const uint32_t sectors = sector_count(message.request.sectors);
  Port& channel = channels_[message.request.line % channels_.size()];
  const Cycle start = channel.reserve(now() * subcycles, sectors * sector_subcycles_);
  if (message.store) {
    stats_.written_sectors[message.request_class] += sectors;
    // Nobody waits for a write, but the run is not over before it is done.
    schedule((channel.next_free() + subcycles - 1) / subcycles, *this, EventKind::write_done);
    return;
  }
  stats_.read_sectors[message.request_class] += sectors;
  // The latency covers the first sector; the others follow at the channel's rate.
  const Cycle last = (start + (sectors - 1) * sector_subcycles_ + subcycles - 1) / subcycles;
  schedule(last + inner_latency_, *l2_, EventKind::memory_response, message.request.line, message.packed());
}

Cycle Dram::busy() const {
  Cycle sum = 0;
  for (const Port& channel : channels_) sum += channel.busy();
  return sum / subcycles;
}

double Dram::peak_bytes_per_cycle() const {
  return static_cast<double>(config_.channels) * sector_bytes * subcycles / static_cast<double>(sector_subcycles_);
}

}  // namespace rayloom::hwmodel
