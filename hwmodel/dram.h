#pragma once

// Device memory: channels by sector address, each with a latency and a bandwidth. Banks, rows and refresh come later;
// the interface (requests in, responses out) does not change with them.

#include <rayloom/hwmodel/engine.h>
#include <rayloom/hwmodel/memory.h>

#include <cstdint>
#include <vector>

namespace rayloom::hwmodel {

class Dram : public Component {
 public:
  struct Config {
    uint32_t channels = 1;
    uint32_t latency = 600;                     ///< load to use, unloaded, from the SM
    uint32_t bandwidth_mb_per_second = 616000;  ///< all channels together, 10^6 bytes
  };
  struct Stats {
    ClassCounts read_sectors;
    ClassCounts written_sectors;

    template <class F>
    static void fields(F&& f) {
      f("read_sectors", &Stats::read_sectors);
      f("written_sectors", &Stats::written_sectors);
    }
  };

  /// `l2_latency`: load to use of an L2 hit; throws UsageError when Config::latency is shorter.
  Dram(Engine& engine, const Config& config, uint32_t l2_latency, uint32_t core_mhz);
  void connect(const Component& l2) { l2_ = &l2; }

  void handle(const Event& event) override;
  void describe_waiting(std::vector<std::string>&) const override {}

  const Stats& stats() const { return stats_; }
  /// Clocks of `channels` channels kept busy, rounded down.
  Cycle busy() const;
  /// Bytes a clock that all channels move at most.
  double peak_bytes_per_cycle() const;

 private:
  // Time in 1/1024 clocks: a sector takes 1.77 clocks of a GDDR6 channel.
  static constexpr uint64_t subcycles = 1024;

  Config config_;
  Cycle inner_latency_;
  uint64_t sector_subcycles_;  // one sector on one channel
  std::vector<Port> channels_;
  const Component* l2_ = nullptr;
  Stats stats_;
};

}  // namespace rayloom::hwmodel
