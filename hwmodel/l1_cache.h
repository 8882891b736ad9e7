#pragma once

// The first-level cache of one SM, shared by its load/store path and its RT core. Loads may be split over many lines;
// the answer comes when the last of them is there. Write-through, no allocation on stores.

#include <rayloom/hwmodel/engine.h>
#include <rayloom/hwmodel/memory.h>
#include <rayloom/hwmodel/mshr.h>

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace rayloom::hwmodel {

struct CrossbarConfig {
  uint32_t latency = 1;           ///< one way, clocks
  uint32_t bytes_per_cycle = 32;  ///< per SM and direction
};

class L1Cache : public Component {
 public:
  struct Config {
    uint32_t kilobytes = 64;
    uint32_t line_bytes = 128;
    uint32_t ways = 4;
    uint32_t latency = 32;         ///< load to use, hit
    uint32_t access_interval = 1;  ///< clocks between lines
    uint32_t mshr_entries = 256;
    uint32_t mshr_waiters = 8;  ///< per entry
  };
  using Stats = CacheStats;

  L1Cache(Engine& engine, uint32_t sm, const Config& config, const CrossbarConfig& crossbar);
  void connect(const Component& l2) { l2_ = &l2; }

  /// Answers `client` with an event of kind `answer`: a = token, b = clocks spent waiting for an MSHR, detail = the
  /// farthest level that served a part (ServedBy).
  void load(std::span<const LineRequest> lines, RequestClass request_class, const Component& client, EventKind answer,
            uint32_t token);
  void store(std::span<const LineRequest> lines, RequestClass request_class);

  void handle(const Event& event) override;
  void describe_waiting(std::vector<std::string>& lines) const override;

  uint32_t line_bytes() const { return config_.line_bytes; }
  const Stats& stats() const { return stats_; }
  Cycle port_busy() const { return port_.busy(); }

 private:
  struct Transaction {
    const Component* client = nullptr;
    EventKind answer{};
    RequestClass request_class{};
    uint32_t token = 0;
    uint32_t pending = 0;  ///< lines not yet there
    Cycle ready = 0;
    Cycle mshr_wait = 0;
    ServedBy served_by = ServedBy::l1;
  };
  struct Blocked {
    uint32_t transaction;
    LineRequest request;
    Cycle since;
  };

  uint32_t new_transaction();
  bool access(uint32_t transaction, const LineRequest& request, Cycle time);
  void request_from_l2(const MemoryMessage& message, Cycle time);
  void line_done(uint32_t transaction, Cycle time, ServedBy served_by);
  void retry_blocked();

  Config config_;
  CrossbarConfig crossbar_;
  uint32_t sm_;
  const Component* l2_ = nullptr;
  SectorCache tags_;
  MshrTable<uint32_t> mshrs_;  // waiters are transactions
  Port port_, request_port_;
  std::vector<Transaction> transactions_;
  std::vector<uint32_t> free_transactions_;
  std::deque<Blocked> blocked_;
  Stats stats_;
};

}  // namespace rayloom::hwmodel
