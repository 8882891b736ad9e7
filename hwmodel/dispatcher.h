#pragma once

// Hands the warps of a launch to SMs with a free slot: round the SMs at first, then to whichever frees one. Launches
// run one after another, with the caches as the one before left them.

#include <rayloom/hwmodel/engine.h>
#include <rayloom/hwmodel/memory.h>

#include <cstdint>
#include <deque>
#include <vector>

namespace rayloom::hwmodel {

class Dispatcher : public Component {
 public:
  struct Config {
    uint32_t launch_overhead = 0;  ///< clocks before the first warp of a launch
    uint32_t interval = 1;         ///< clocks between warps
    uint32_t latency = 20;         ///< to an SM
  };
  struct Stats {
    uint64_t warps = 0, launches = 0;

    template <class F>
    static void fields(F&& f) {
      f("warps", &Stats::warps);
      f("launches", &Stats::launches);
    }
  };

  /// `warps`: how many each launch has.
  Dispatcher(Engine& engine, const Config& config, std::vector<uint64_t> warps);
  /// Each SM takes `slots` warps at a time.
  void connect(std::vector<const Component*> sms, uint32_t slots);
  /// Puts the first event into the queue.
  void start();

  void handle(const Event& event) override;
  void describe_waiting(std::vector<std::string>& lines) const override;

  const Stats& stats() const { return stats_; }

 private:
  void begin_launch(uint32_t launch);
  void hand_out();

  Config config_;
  std::vector<uint64_t> warps_;
  std::vector<const Component*> sms_;
  std::deque<uint32_t> free_slots_;  // SMs, one entry a free slot
  Port port_;
  uint32_t launch_ = 0;
  uint64_t next_warp_ = 0, unfinished_ = 0;
  Stats stats_;
};

}  // namespace rayloom::hwmodel
