// Divergence, coalescing and issue, as equal integers (docs/hwmodel.md).

#include "synthetic.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::hwmodel;
using namespace rayloom::hwmodel::test;

TEST_CASE("SIMT: k branch signatures of cost c take k * c warp operations, efficiency 1 / k") {
  const uint32_t k = GENERATE(1u, 2u, 3u, 8u, 32u);
  constexpr uint32_t cost = 40;
  Arena arena(1 << 16);
  const Capture capture = capture_lanes(arena, {shader("raygen", cost)}, 32, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.branch(index % k + 1);
    lane.end();
  });
  const GpuStats stats = run(capture, plain_config()).stats;
  REQUIRE(stats.shaders.size() == 1);
  CHECK(stats.shaders[0].stats.warp_operations == k * cost);
  CHECK(stats.shaders[0].stats.lane_operations == 32 * cost);
  CHECK(stats.shaders[0].stats.invocations == 32);
  CHECK(stats.shaders[0].stats.lane_operations * k == stats.shaders[0].stats.warp_operations * 32);
  CHECK(stats.cycles == k * cost * plain_config().sm.dependency_latency);
}

TEST_CASE("SIMT: shaders of different lanes do not share instructions") {
  Arena arena(1 << 16);
  const std::vector<ShaderInfo> shaders{shader("raygen", 10), shader("red", 20, ShaderStage::callable),
                                        shader("blue", 30, ShaderStage::callable)};
  const Capture capture = capture_lanes(arena, shaders, 32, [](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.call();
    lane.begin(1 + index % 2);
    lane.end();
    lane.load(64 * uint64_t{index}, 4);  // all lanes again
    lane.end();
  });
  const GpuStats stats = run(capture, plain_config()).stats;
  CHECK(stats.sm.warp_operations == 10 + 20 + 30);
  CHECK(stats.sm.lane_operations == 32 * 10 + 16 * 20 + 16 * 30);
  CHECK(stats.sm.memory_instructions == 1);
}

TEST_CASE("SIMT: lanes that call deeper run first and the callers go on together") {
  Arena arena(1 << 16);
  const std::vector<ShaderInfo> shaders{shader("raygen", 4), shader("f", 8, ShaderStage::callable),
                                        shader("g", 16, ShaderStage::callable)};
  // Even lanes: raygen, f, g inside f; odd lanes: raygen, f. All load at the end of raygen.
  const Capture capture = capture_lanes(arena, shaders, 32, [](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.call();
    lane.begin(1);
    if (index % 2 == 0) lane.call(), lane.begin(2), lane.end(), lane.load(4096, 4);
    lane.end();
    lane.load(8192, 4);
    lane.end();
  });
  const GpuStats stats = run(capture, plain_config()).stats;
  CHECK(stats.sm.warp_operations == 4 + 8 + 16);
  CHECK(stats.sm.memory_instructions == 2);
  CHECK(stats.l1.line_accesses[RequestClass::shader_data] == 2);
}

TEST_CASE("loads of a group coalesce to sectors, instruction by instruction") {
  Arena arena(1 << 16);
  const uint32_t stride = GENERATE(0u, 4u, 32u, 256u);
  const Capture capture = capture_lanes(arena, free_shader(), 32, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0);
    lane.load(0x10000 + uint64_t{index} * stride, 4);
    lane.end();
  });
  const GpuStats stats = run(capture, plain_config()).stats;
  const uint64_t bytes = 31 * stride + 4;
  CHECK(stats.l1.accesses[RequestClass::shader_data] == std::min<uint64_t>(32, (bytes + 31) / 32));
  CHECK(stats.l1.line_accesses[RequestClass::shader_data] == std::min<uint64_t>(32, (bytes + 255) / 256));
}

TEST_CASE("issue: w warps of a sub-partition issue min(1, w / dependency latency) a clock") {
  const uint32_t warps = GENERATE(1u, 2u, 3u, 4u, 8u);
  constexpr uint32_t cost = 1600;
  Arena arena(1 << 16);
  GpuConfig config = plain_config();
  config.sm.sub_partitions = 1;
  config.sm.dependency_latency = 4;
  config.dispatcher.interval = 0;
  const Capture capture = capture_lanes(arena, {shader("raygen", cost)}, warps * 32, [](LaneScript& lane, uint32_t) {
    lane.begin(0);
    lane.end();
  });
  const GpuStats stats = run(capture, config).stats;
  const uint64_t busy = std::max(warps, config.sm.dependency_latency);
  // All start together, each a bundle after the other; the last dependency ends the run.
  const uint64_t stagger = config.sm.bundle * (std::min(warps, config.sm.dependency_latency) - 1);
  CHECK(stats.sm.issued_cycles == uint64_t{warps} * cost);
  if (warps <= config.sm.dependency_latency) {
    CHECK(stats.cycles == cost * busy + stagger);
  } else {
    CHECK(stats.cycles == cost * busy + config.sm.bundle * (config.sm.dependency_latency - 1));
  }
  CHECK(stats.sm.issue[IssueState::issuing] == uint64_t{warps} * cost);
  CHECK(stats.sm.issue.total() == stats.cycles);
}

TEST_CASE("special instructions take the issue slot for their interval") {
  Arena arena(1 << 16);
  GpuConfig config = plain_config();
  config.sm.special_interval = 8;
  const std::vector<ShaderInfo> shaders{{"raygen", ShaderStage::ray_generation, {0, 10}}};
  const Capture capture = capture_lanes(arena, shaders, 32, [](LaneScript& lane, uint32_t) {
    lane.begin(0);
    lane.end();
  });
  CHECK(run(capture, config).stats.cycles == 80);
}

TEST_CASE("lane clocks: a pixel pays for its own work only, and all of them make up the residence") {
  Arena arena(1 << 16);
  const Capture capture = capture_lanes(arena, {shader("raygen", 10), shader("heavy", 1000, ShaderStage::callable)}, 40,
                                        [](LaneScript& lane, uint32_t index) {
                                          lane.begin(0);
                                          if (index == 3) lane.call(), lane.begin(1), lane.end();
                                          lane.end();
                                        });
  const ReplayResult result = run(capture, plain_config());
  const std::vector<uint64_t>& pixels = result.pixel_cycles.at(0);
  REQUIRE(pixels.size() == 40);
  CHECK(pixels[2] == 10 * 4);
  CHECK(pixels[3] == 1010 * 4);
  CHECK(pixels[39] == 10 * 4);
  uint64_t sum = 0;
  for (const uint64_t cycles : pixels) sum += cycles;
  CHECK(sum == result.stats.sm.lane_busy_cycles);
  CHECK(sum + result.stats.sm.lane_idle_cycles + result.stats.sm.lane_absent_cycles ==
        32 * result.stats.sm.warp_residence);
}

TEST_CASE("warps beyond the slots wait at the dispatcher, and slots know when they had none") {
  Arena arena(1 << 16);
  GpuConfig config = plain_config();
  config.sm.warp_slots = 4;
  config.sm.count = 2;
  config.dispatcher.latency = 30;
  const Capture capture = capture_lanes(arena, {shader("raygen", 10)}, 32 * 17, [](LaneScript& lane, uint32_t) {
    lane.begin(0);
    lane.end();
  });
  const GpuStats stats = run(capture, config).stats;
  CHECK(stats.sm.warps == 17);
  CHECK(stats.sm.slots[WarpSlotState::before_first_warp] >= 8 * 30);
  CHECK(stats.sm.slots[WarpSlotState::between_warps] > 0);
  CHECK(stats.sm.slots[WarpSlotState::after_last_warp] > 0);
  CHECK(stats.sm.slots.total() == stats.cycles * 8);
}
