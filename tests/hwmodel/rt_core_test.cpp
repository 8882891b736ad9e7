// Times of the RT core in closed form (docs/hwmodel.md), as equal integers.

#include "synthetic.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::hwmodel;
using namespace rayloom::hwmodel::test;

namespace {

/// Clocks that one more trace of `structure` by a single ray takes when everything it needs is in the L1.
Cycle warm_trace(const Arena& arena, uint64_t structure, const GpuConfig& config) {
  const auto cycles = [&](int traces) {
    const Capture capture = capture_lanes(arena, free_shader(), 1, [&](LaneScript& lane, uint32_t) {
      lane.begin(0);
      for (int i = 0; i < traces; ++i) lane.trace(structure);
      lane.end();
    });
    return run(capture, config).stats.cycles;
  };
  return cycles(3) - cycles(2);
}

/// Every lane traces chains[lane % size] once, after lane 0 alone did so for all of them when `warm`.
Capture trace_all(const Arena& arena, const std::vector<Chain>& chains, uint32_t lanes, int repeats = 1) {
  return capture_lanes(arena, free_shader(), lanes, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    for (int i = 0; i < repeats; ++i) lane.trace(chains[index % chains.size()].address);
    lane.end();
  });
}

Cycle step_of(const GpuConfig& c) { return c.rt.schedule_latency + c.l1.latency + c.rt.box_latency; }

}  // namespace

TEST_CASE("chain latency: a node more costs schedule + L1 + box, exactly") {
  Arena arena(1 << 20);
  const auto [schedule, l1, box] = GENERATE(table<uint32_t, uint32_t, uint32_t>({{1, 32, 10}, {3, 20, 13}, {0, 1, 1}}));
  GpuConfig config = plain_config();
  config.rt.schedule_latency = schedule;
  config.l1.latency = l1;
  config.rt.box_latency = box;
  Cycle previous = warm_trace(arena, make_chain(arena, 1).address, config);
  const Cycle intercept = previous - step_of(config);
  CHECK(intercept == 1 + config.rt.return_latency);  // a clock to read the ray in, and the way back
  for (uint32_t nodes = 2; nodes <= 12; ++nodes) {
    const Cycle cycles = warm_trace(arena, make_chain(arena, nodes).address, config);
    CHECK(cycles - previous == step_of(config));
    previous = cycles;
  }
}

TEST_CASE("a node wider than its port takes the port's beats less one more") {
  Arena arena(1 << 20);
  GpuConfig config = plain_config();
  config.rt.fetch_bytes_per_cycle = 64;  // 224 bytes: four beats
  const Cycle two = warm_trace(arena, make_chain(arena, 2).address, config);
  const Cycle three = warm_trace(arena, make_chain(arena, 3).address, config);
  CHECK(three - two == step_of(config) + 3);
}

TEST_CASE("triangle latency: slope one over rate, intercept the pipe's latency") {
  Arena arena(1 << 20);
  const uint32_t rate = GENERATE(1u, 2u, 4u);
  GpuConfig config = plain_config();
  config.rt.triangle_rate = rate;
  const Cycle none = warm_trace(arena, make_chain(arena, 1).address, config);
  for (uint32_t triangles = 1; triangles <= 8; ++triangles) {
    const Cycle cycles = warm_trace(arena, make_chain(arena, 1, triangles).address, config);
    const Cycle busy = (triangles + rate - 1) / rate;
    // The leaf is 352 bytes: two lines, two beats, the second one clock after the first.
    const Cycle fetch = config.rt.schedule_latency + config.l1.latency + 1;
    CHECK(cycles - none == fetch + busy - 1 + config.rt.triangle_latency);
  }
}

TEST_CASE("merge: 32 lanes at one node make one line access, at 32 nodes 32; box operations are 32 in both") {
  Arena arena(1 << 20);
  std::vector<Chain> same{make_chain(arena, 1)}, different;
  for (int i = 0; i < 32; ++i) different.push_back(make_chain(arena, 1));
  const GpuStats merged = run(trace_all(arena, same, 32), plain_config()).stats;
  const GpuStats apart = run(trace_all(arena, different, 32), plain_config()).stats;
  CHECK(merged.rt.fetches == 1);
  CHECK(merged.l1.line_accesses[RequestClass::bottom_node] == 1);
  CHECK(apart.rt.fetches == 32);
  CHECK(apart.l1.line_accesses[RequestClass::bottom_node] == 32);
  CHECK(merged.rt.box_busy == 32);
  CHECK(apart.rt.box_busy == 32);
  CHECK(merged.rt.box_tests == 32 * 8);
  CHECK(apart.rt.box_tests == 32 * 8);
}

TEST_CASE("box rate: the least of pipe rate, port rate and rays over latency, within one percent after warm-up") {
  Arena arena(16 << 20);
  const auto [lanes, box_interval, port_bytes] =
      GENERATE(table<uint32_t, uint32_t, uint32_t>({{4, 1, 256}, {128, 1, 256}, {128, 3, 256}, {128, 1, 56}}));
  GpuConfig config = plain_config();
  config.rt.box_interval = box_interval;
  config.rt.fetch_bytes_per_cycle = port_bytes;
  config.l1.kilobytes = 8192;
  constexpr uint32_t nodes = 40;
  std::vector<Chain> chains;
  for (uint32_t i = 0; i < lanes; ++i) chains.push_back(make_chain(arena, nodes));
  // One long warm trace against a longer one: the difference has neither cold misses nor ends.
  const auto cycles = [&, lanes = lanes](int repeats) {
    return run(trace_all(arena, chains, lanes, repeats), config).stats.cycles;
  };
  const auto more = static_cast<double>(cycles(22) - cycles(2));
  const double beats = (224 + port_bytes - 1) / port_bytes;
  const double latency = static_cast<double>(step_of(config)) + beats - 1;
  const double bound = std::min({1.0 / box_interval, 1.0 / beats, lanes / latency});
  // Rays that start or return do not test: one trace of `nodes` steps, and these clocks.
  const double ends = 1 + config.rt.return_latency;
  const double rate = 20.0 * lanes * nodes / more;
  const double unbound = lanes / (latency + ends / nodes);
  INFO("rate " << rate << ", bound " << bound);
  CHECK(rate <= bound * 1.01);
  CHECK(rate >= std::min(bound, unbound) * 0.99);
}

TEST_CASE("Little: occupied slots over time equal the residence of what passed through") {
  Arena arena(4 << 20);
  std::vector<Chain> chains;
  for (uint32_t i = 1; i < 40; ++i) chains.push_back(make_chain(arena, i, i % 9));
  GpuConfig config = plain_config();
  config.rt.warp_entries = 2;
  const GpuStats stats = run(trace_all(arena, chains, 500, 3), config).stats;
  CHECK(stats.rt.rays == 1500);
  CHECK(stats.rt.ray_residence > 0);
  CHECK(stats.rt.ray_residence == stats.rt.occupied_slot_cycles);
  CHECK(stats.sm.warp_residence == stats.sm.occupied_slot_cycles);
  CHECK(stats.sm.slots[WarpSlotState::rt_buffer_full] > 0);
}

TEST_CASE("siblings: 31 rays of one node wait for the one of N") {
  Arena arena(4 << 20);
  constexpr uint32_t nodes = 200;
  const Chain brief = make_chain(arena, 1), lengthy = make_chain(arena, nodes);
  const GpuConfig config = plain_config();
  const Capture capture = capture_lanes(arena, free_shader(), 32, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.trace(index == 0 ? lengthy.address : brief.address);
    lane.end();
  });
  const Capture alone = capture_lanes(arena, free_shader(), 1, [&](LaneScript& lane, uint32_t) {
    lane.begin(0);
    lane.trace(lengthy.address);
    lane.end();
  });
  const ReplayResult together = run(capture, config);
  CHECK(together.stats.cycles == run(alone, config).stats.cycles);
  const StateTable<RaySlotState>& slots = together.stats.rt.slots;
  const double used = 1 - static_cast<double>(slots[RaySlotState::wait_siblings]) /
                              static_cast<double>(together.stats.rt.ray_residence);
  CHECK(used < 1.2 / 32);
  // A pixel pays for its own ray alone.
  CHECK(together.pixel_cycles[0][0] > 100 * together.pixel_cycles[0][1]);
}

TEST_CASE("callbacks: n any-hit shaders of cost c add n times c and a round trip, exactly") {
  Arena arena(1 << 20);
  GpuConfig config = plain_config();
  config.rt.callback_latency = 17;
  constexpr uint32_t cost = 5;
  const Chain chain = make_chain(arena, 1, 8, 0);
  struct Asker {
    LaneScript* lane;
    uint32_t runs, asked;
  };
  // The first `runs` candidates run a shader; all are ignored.
  const auto ask = [](void* user, const accel::Candidate&) noexcept -> accel::Verdict {
    auto& asker = *static_cast<Asker*>(user);
    if (asker.asked++ < asker.runs) asker.lane->begin(1), asker.lane->end();
    return {};
  };
  const auto cycles = [&](uint32_t runs) {
    const std::vector<ShaderInfo> shaders{shader("free", 0), shader("any hit", cost, ShaderStage::any_hit)};
    const Capture capture = capture_lanes(arena, shaders, 1, [&](LaneScript& lane, uint32_t) {
      Asker asker{&lane, runs, 0};
      lane.begin(0);
      lane.trace(chain.address, down_z(), 0, ask, &asker);
      lane.end();
    });
    return run(capture, config).stats.cycles;
  };
  const Cycle none = cycles(0);
  for (uint32_t runs = 1; runs <= 8; ++runs)
    CHECK(cycles(runs) - none == runs * (cost * config.sm.dependency_latency + 2 * config.rt.callback_latency));
}

TEST_CASE("a second warp waits while the buffer is full, and is told so") {
  Arena arena(1 << 20);
  GpuConfig config = plain_config();
  config.rt.warp_entries = 1;
  const std::vector<Chain> chains{make_chain(arena, 10)};
  const GpuStats stats = run(trace_all(arena, chains, 64), config).stats;
  CHECK(stats.sm.slots[WarpSlotState::rt_buffer_full] > 0);
  config.rt.warp_entries = 2;
  CHECK(run(trace_all(arena, chains, 64), config).stats.sm.slots[WarpSlotState::rt_buffer_full] == 0);
}
