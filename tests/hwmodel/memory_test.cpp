// Caches, MSHRs, crossbar and DRAM: pieces by themselves, then their times in closed form.

#include "synthetic.h"

#include <rayloom/base/error.h>
#include <rayloom/hwmodel/mshr.h>
#include <rayloom/hwmodel/sector_cache.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::hwmodel;
using namespace rayloom::hwmodel::test;

TEST_CASE("a cache set forgets its least recently used line") {
  SectorCache cache(2, 2);  // lines of one parity share a set
  cache.fill(0, 1, false);
  cache.fill(2, 3, false);
  CHECK(cache.lookup(0) == 1);
  cache.fill(4, 1, false);  // 2 was used longest ago
  CHECK(cache.lookup(0) == 1);
  CHECK(cache.lookup(2) == 0);
  CHECK(cache.lookup(4) == 1);
  CHECK(cache.lookup(1) == 0);
}

TEST_CASE("sectors come one by one, and dirty ones are handed out on eviction") {
  SectorCache cache(1, 1);
  CHECK_FALSE(cache.fill(7, 0b0001, true));
  CHECK_FALSE(cache.fill(7, 0b0110, false));
  CHECK(cache.lookup(7) == 0b0111);
  const auto evicted = cache.fill(8, 1, false);
  REQUIRE(evicted);
  CHECK(evicted->line == 7);
  CHECK(evicted->dirty == 0b0001);
  CHECK_FALSE(cache.fill(9, 1, false));
}

TEST_CASE("MSHRs merge, ask once for a sector, and say when they are full") {
  using Table = MshrTable<int>;
  Table table(2, 2);
  auto result = table.add(10, 0b01, 1);
  CHECK((result.outcome == Table::Outcome::allocated && result.request == 0b01));
  result = table.add(10, 0b11, 2);
  CHECK((result.outcome == Table::Outcome::merged && result.request == 0b10));
  CHECK(table.add(10, 0b01, 3).outcome == Table::Outcome::full);  // no third waiter
  CHECK(table.add(11, 0b01, 4).outcome == Table::Outcome::allocated);
  CHECK(table.add(12, 0b01, 5).outcome == Table::Outcome::full);  // no third entry
  std::vector<int> woken;
  table.filled(10, 0b01, [&](int who) { woken.push_back(who); });
  CHECK(woken == std::vector<int>{1});
  table.filled(10, 0b10, [&](int who) { woken.push_back(who); });
  CHECK(woken == std::vector<int>{1, 2});
  CHECK(table.size() == 1);
}

TEST_CASE("lines of an access") {
  std::vector<LineRequest> lines;
  add_lines(lines, 96, 224, 128);  // sectors 3 to 9
  REQUIRE(lines.size() == 3);
  CHECK((lines[0].line == 0 && lines[0].sectors == 0b1000));
  CHECK((lines[1].line == 1 && lines[1].sectors == 0b1111));
  CHECK((lines[2].line == 2 && lines[2].sectors == 0b0011));
  add_lines(lines, 0, 4, 128);
  CHECK(lines.size() == 3);
  CHECK(lines[0].sectors == 0b1001);
}

namespace {

/// Clocks of `loads` dependent loads, `stride` bytes apart, going round `lines` places.
Cycle chase(const GpuConfig& config, uint32_t loads, uint32_t lines, uint32_t stride = 256) {
  Arena arena(1 << 16);
  const Capture capture = capture_lanes(arena, free_shader(), 1, [&](LaneScript& lane, uint32_t) {
    lane.begin(0);
    for (uint32_t i = 0; i < loads; ++i) {
      lane.begin(0);  // a call a load: each waits for the one before
      lane.load(0x100000 + uint64_t{i % lines} * stride, 4);
      lane.end();
    }
    lane.end();
  });
  return run(capture, config).stats.cycles;
}

}  // namespace

TEST_CASE("pointer chase: plateaus equal the latencies of L1, L2 and DRAM") {
  GpuConfig config = plain_config();
  config.l1.kilobytes = 4;             // 16 lines
  config.l2.kilobytes_per_slice = 64;  // 256 lines
  config.l2.slices = 2;
  const Cycle issue = config.sm.memory_interval;
  const auto plateau = [&](uint32_t lines) {
    const Cycle longer = chase(config, 4 * lines, lines), shorter = chase(config, 3 * lines, lines);
    REQUIRE((longer - shorter) % lines == 0);
    return (longer - shorter) / lines;
  };
  CHECK(plateau(8) == issue + config.l1.latency);
  CHECK(plateau(16) == issue + config.l1.latency);
  CHECK(plateau(32) == issue + config.l2.latency);  // LRU: a ring too large by one set misses always
  CHECK(plateau(512) == issue + config.l2.latency);
  CHECK(plateau(1024) == issue + config.dram.latency);
}

TEST_CASE("MSHR bound: missing nodes come at no more than MSHRs over miss latency, and at that within two percent") {
  const uint32_t entries = GENERATE(1u, 4u, 16u);
  Arena arena(64 << 20);
  GpuConfig config = plain_config();
  config.l1.mshr_entries = entries;
  config.l1.kilobytes = 1;
  config.l2.kilobytes_per_slice = 16;
  constexpr uint32_t nodes = 100, lanes = 64;
  std::vector<Chain> chains;
  for (uint32_t i = 0; i < lanes; ++i) chains.push_back(make_chain(arena, nodes));
  const Capture capture = capture_lanes(arena, free_shader(), lanes, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.trace(chains[index].address);
    lane.end();
  });
  const GpuStats stats = run(capture, config).stats;
  const double rate = static_cast<double>(lanes) * nodes / static_cast<double>(stats.cycles);
  const double bound = static_cast<double>(entries) / config.dram.latency;
  CHECK(stats.l1.misses.total() == lanes * nodes * 7);
  CHECK(rate <= bound);
  CHECK(rate >= 0.98 * bound);
  CHECK(stats.l1.mshr_full > 0);
  CHECK(stats.l1.mshr_peak == entries);
  CHECK(stats.rt.slots[RaySlotState::wait_mshr] > 0);
}

TEST_CASE("an L2 without free MSHRs holds its requests back, and loses none") {
  Arena arena(64 << 20);
  GpuConfig config = plain_config();
  config.l2.mshr_entries = 2;
  config.l2.kilobytes_per_slice = 16;
  std::vector<Chain> chains;
  for (uint32_t i = 0; i < 32; ++i) chains.push_back(make_chain(arena, 20));
  const Capture capture = capture_lanes(arena, free_shader(), 32, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.trace(chains[index].address);
    lane.end();
  });
  const GpuStats stats = run(capture, config).stats;
  CHECK(stats.l2.mshr_full > 0);
  CHECK(stats.l2.mshr_peak == 2);
  const Cycle inner = config.dram.latency - 2 * config.crossbar.latency;
  CHECK(stats.cycles * 2 >= 32 * 20 * (inner - (config.l2.latency - 2 * config.crossbar.latency)));
}

TEST_CASE("DRAM bandwidth bounds a stream") {
  Arena arena(1 << 16);
  GpuConfig config = plain_config();
  config.core_mhz = 1000;
  config.dram.channels = 4;
  config.dram.bandwidth_mb_per_second = 16000;  // 16 bytes a clock
  config.sm.memory_interval = 1;
  constexpr uint32_t lanes = 1024, loads = 8;
  const Capture capture = capture_lanes(arena, free_shader(), lanes, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    for (uint32_t i = 0; i < loads; ++i) lane.load(0x1000000 + (uint64_t{index} * loads + i) * 128, 128);
    lane.end();
  });
  const GpuStats stats = run(capture, config).stats;
  const double bytes = double{lanes} * loads * 128;
  const double rate = bytes / static_cast<double>(stats.cycles);
  CHECK(stats.dram.read_sectors.total() * 32 == lanes * loads * 128);
  CHECK(rate <= 16);
  CHECK(rate >= 0.97 * 16);
}

TEST_CASE("stores reach DRAM when their lines are driven out, each once") {
  Arena arena(1 << 16);
  GpuConfig config = plain_config();
  config.l2.kilobytes_per_slice = 8;  // 32 lines
  config.l2.ways = 4;
  const Capture capture = capture_lanes(arena, free_shader(), 4096, [](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.store(0x1000000 + uint64_t{index} * 32, index);
    lane.end();
  });
  const GpuStats stats = run(capture, config).stats;
  CHECK(stats.l1.stores[RequestClass::shader_data] == 4096);
  CHECK(stats.dram.written_sectors.total() == 4096 - 32 * 8);
  CHECK(stats.dram.read_sectors.total() == 0);
}

TEST_CASE("latencies that contradict each other are refused") {
  GpuConfig config = plain_config();
  config.crossbar.latency = 200;
  CHECK_THROWS_AS(check_config(config), UsageError);
  config = plain_config();
  config.dram.latency = config.l2.latency - 1;
  CHECK_THROWS_AS(check_config(config), UsageError);
  config = plain_config();
  config.l1.line_bytes = 96;
  CHECK_THROWS_AS(check_config(config), UsageError);
  config = plain_config();
  config.l1.ways = 3;
  CHECK_THROWS_AS(check_config(config), UsageError);
}
