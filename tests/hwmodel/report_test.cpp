#include "synthetic.h"

#include <rayloom/base/json.h>
#include <rayloom/hwmodel/report.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::hwmodel;
using namespace rayloom::hwmodel::test;

namespace {

ReplayResult small_run(const GpuConfig& config) {
  Arena arena(1 << 20);
  const Chain chain = make_chain(arena, 6, 3);
  const std::vector<ShaderInfo> shaders{shader("raygen", 20), shader("shade", 30, ShaderStage::closest_hit)};
  return run(capture_lanes(arena, shaders, 100,
                           [&](LaneScript& lane, uint32_t index) {
                             lane.begin(0);
                             lane.trace(chain.address);
                             lane.begin(1);
                             if (index % 2) lane.trace(chain.address);
                             lane.load(0x9000 + index * 4, 4);
                             lane.end();
                             lane.store(0xA000 + index * 4, index);
                             lane.end();
                           }),
             config);
}

double metric(const GpuStats& stats, const std::string& name) {
  for (const Metric& m : metrics(stats))
    if (m.name == name) return m.value;
  FAIL("no metric " << name);
  return 0;
}

}  // namespace

TEST_CASE("cycle tables sum to clocks times units, with no row to catch the rest") {
  const GpuStats stats = small_run(make_preset("turing").config).stats;
  for (const CycleTable& table : cycle_tables(stats)) {
    uint64_t sum = 0;
    for (const CycleTable::Row& row : table.rows) {
      sum += row.cycles;
      CHECK(row.cause != "other");
    }
    CHECK(sum == table.total);
    CHECK(table.total % stats.cycles == 0);
  }
}

TEST_CASE("metrics are what they are called") {
  const GpuStats stats = small_run(make_preset("turing").config).stats;
  CHECK(metric(stats, "rays") == 150);
  CHECK(metric(stats, "nodes_per_ray") == 6);
  CHECK(metric(stats, "triangle_tests_per_ray") == 3);
  const double seconds = static_cast<double>(stats.cycles) / 1545e6;
  CHECK(metric(stats, "rays_mega_per_second") == Approx(150 / seconds / 1e6));
  CHECK(metric(stats, "rays_depth_0_mega_per_second") == Approx(100 / seconds / 1e6));
  CHECK(metric(stats, "rays_depth_1_mega_per_second") == Approx(50 / seconds / 1e6));
  CHECK(metric(stats, "clocks_per_ray_per_rt_core") == Approx(static_cast<double>(stats.cycles) * 68 / 150));
  for (const Metric& m : metrics(stats))
    if (m.name.ends_with("_percent")) CHECK((m.value >= 0 && m.value <= 100));
}

TEST_CASE("text, JSON and CSV say the same") {
  const GpuPreset preset = make_preset("turing");
  const GpuStats stats = small_run(preset.config).stats;
  const Json json = Json::parse(report_json(stats, preset));
  CHECK(json["schema"] == "rayloom.simulation");
  CHECK(json["metrics"]["cycles"] == stats.cycles);
  CHECK(json["counters"]["rt"]["rays"] == 150);
  CHECK(json["counters"]["l1"]["accesses"]["bottom_node"] == stats.l1.accesses[RequestClass::bottom_node]);
  CHECK(json["gpu"]["preset"] == "turing");
  uint64_t sum = 0;
  for (const auto& [cause, cycles] : json["cycle_tables"]["rt_ray_slots"]["cycles"].items())
    sum += cycles.get<uint64_t>();
  CHECK(json["cycle_tables"]["rt_ray_slots"]["total"] == sum);
  CHECK(json["shaders"][0]["name"] == "raygen");
  const std::string cycles = std::to_string(stats.cycles);
  CHECK_THAT(report_csv(stats), Catch::Contains("cycles," + cycles) && Catch::Contains("rt_ray_slots.in_box_cycles,"));
  CHECK_THAT(report_text(stats), Catch::Contains(cycles) && Catch::Contains("raygen"));
}

TEST_CASE("books that do not balance are refused") {
  const GpuStats good = small_run(make_preset("turing").config).stats;
  CHECK_NOTHROW(check_books(good));
  const auto refused = [&](auto change) {
    GpuStats bad = good;
    change(bad);
    try {
      check_books(bad);
    } catch (const std::logic_error&) {
      return true;
    }
    return false;
  };
  CHECK(refused([](GpuStats& s) { ++s.rt.slots[RaySlotState::in_box]; }));
  CHECK(refused([](GpuStats& s) { --s.sm.slots[WarpSlotState::issuing]; }));
  CHECK(refused([](GpuStats& s) { ++s.sm.issue[IssueState::memory]; }));
  CHECK(refused([](GpuStats& s) { --s.rt.rays_returned; }));
  CHECK(refused([](GpuStats& s) { ++s.rt.nodes; }));
  CHECK(refused([](GpuStats& s) { ++s.rt.ray_residence; }));
  CHECK(refused([](GpuStats& s) { ++s.l1.hits[RequestClass::leaf]; }));
  CHECK(refused([](GpuStats& s) { ++s.l2.accesses[RequestClass::leaf]; }));
  CHECK(refused([](GpuStats& s) { ++s.dram.read_sectors[RequestClass::leaf]; }));
  CHECK(refused([](GpuStats& s) { s.rt.box_busy = s.cycles * 68 + 1; }));
  CHECK(refused([](GpuStats& s) { ++s.sm.lane_idle_cycles; }));
}
