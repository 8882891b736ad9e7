#pragma once

// The second-level cache, shared by all SMs: slices by line address, each with a port, tags and MSHRs. Write-back;
// a store allocates its sectors without fetching them.

#include <rayloom/hwmodel/engine.h>
#include <rayloom/hwmodel/l1_cache.h>
#include <rayloom/hwmodel/memory.h>
#include <rayloom/hwmodel/mshr.h>

#include <cstdint>
#include <deque>
#include <vector>

namespace rayloom::hwmodel {

class L2Cache : public Component {
 public:
  struct Config {
    uint32_t slices = 1;
    uint32_t kilobytes_per_slice = 256;
    uint32_t ways = 16;
    uint32_t latency = 200;         ///< load to use, hit, over both crossings
    uint32_t bytes_per_cycle = 64;  ///< per slice
    uint32_t mshr_entries = 192;    ///< per slice
    uint32_t mshr_waiters = 16;     ///< per entry
  };
  using Stats = CacheStats;

  /// Line size is the L1's. Throws UsageError when `latency` is shorter than two crossings.
  L2Cache(Engine& engine, const Config& config, const CrossbarConfig& crossbar, uint32_t line_bytes);
  void connect(std::vector<const Component*> l1s, const Component& dram);

  /// memory_request from an L1 (c = SM), memory_response from DRAM.
  void handle(const Event& event) override;
  void describe_waiting(std::vector<std::string>& lines) const override;

  const Stats& stats() const { return stats_; }
  Cycle port_busy() const;

 private:
  struct Waiter {
    uint32_t sm;
    SectorMask sectors;  // all that it asked for, sent back together
  };
  struct Blocked {
    MemoryMessage message;
    uint32_t sm;
    Cycle since;
  };
  struct Slice {
    Slice(uint32_t sets, const Config& config)
        : tags(sets, config.ways), mshrs(config.mshr_entries, config.mshr_waiters) {}
    SectorCache tags;
    MshrTable<Waiter> mshrs;
    Port port;
    std::deque<Blocked> blocked;
  };

  Slice& slice_of(uint64_t line) { return slices_[line % slices_.size()]; }
  uint64_t line_in_slice(uint64_t line) const { return line / slices_.size(); }
  void request(const MemoryMessage& message, uint32_t sm);
  bool load(Slice& slice, const MemoryMessage& message, uint32_t sm, Cycle time);
  void filled(const LineRequest& fill);
  void insert(Slice& slice, const LineRequest& fill, bool dirty);
  void respond(uint32_t sm, const LineRequest& request, Cycle time, ServedBy served_by);
  void retry_blocked(Slice& slice);

  Config config_;
  CrossbarConfig crossbar_;
  Cycle inner_latency_;  // of a hit, without the crossings
  std::vector<const Component*> l1s_;
  const Component* dram_ = nullptr;
  std::vector<Slice> slices_;
  std::vector<Port> return_ports_;  // by SM
  Stats stats_;
};

}  // namespace rayloom::hwmodel
