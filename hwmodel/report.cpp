#include <rayloom/base/csv.h>
#include <rayloom/base/json.h>
#include <rayloom/hwmodel/report.h>
#include <fmt/format.h>

#include <type_traits>

namespace rayloom::hwmodel {

namespace {

double ratio(double part, double whole) { return whole == 0 ? 0 : part / whole; }
double ratio(uint64_t part, uint64_t whole) { return ratio(static_cast<double>(part), static_cast<double>(whole)); }
double percent(uint64_t part, uint64_t whole) { return 100 * ratio(part, whole); }

const char* stage_name(ShaderStage stage) {
  constexpr const char* names[] = {"ray_generation", "intersection", "any_hit", "closest_hit", "miss", "callable"};
  return names[static_cast<size_t>(stage)];
}

double seconds(const GpuStats& stats) { return static_cast<double>(stats.cycles) / (stats.config.core_mhz * 1e6); }

double simt_percent(const GpuStats& stats, uint64_t lane_operations, uint64_t warp_operations) {
  return percent(lane_operations, warp_operations * stats.warp_size);
}

void add_rates(const GpuStats& stats, std::vector<Metric>& out) {
  const double million_per_second = ratio(1e-6, seconds(stats));
  out.push_back({"cycles", static_cast<double>(stats.cycles)});
  out.push_back({"time_ms", seconds(stats) * 1e3});
  out.push_back({"rays", static_cast<double>(stats.rt.rays)});
  out.push_back({"rays_mega_per_second", static_cast<double>(stats.rt.rays) * million_per_second});
  for (size_t depth = 0; depth < stats.rays_by_depth.size(); ++depth)
    out.push_back({fmt::format("rays_depth_{}_mega_per_second", depth),
                   static_cast<double>(stats.rays_by_depth[depth]) * million_per_second});
  out.push_back({"clocks_per_ray_per_rt_core", ratio(stats.cycles * stats.config.sm.count, stats.rt.rays)});
  out.push_back({"nodes_per_ray", ratio(stats.rt.nodes, stats.rt.rays)});
  out.push_back({"triangle_tests_per_ray", ratio(stats.rt.triangle_tests, stats.rt.rays)});
}

void add_units(const GpuStats& stats, std::vector<Metric>& out) {
  const uint64_t clocks = stats.cycles * stats.config.sm.count;
  const RtCore::Stats& rt = stats.rt;
  const uint64_t ray_slots = clocks * stats.config.rt.warp_entries * stats.warp_size;
  const uint64_t entries = rt.slots.total() - rt.slots[RaySlotState::free];
  const uint64_t working = rt.ray_residence - rt.slots[RaySlotState::wait_siblings] -
                           rt.slots[RaySlotState::wait_return] - rt.slots[RaySlotState::load_ray];
  out.push_back({"rt_box_utilisation_percent", percent(rt.box_busy, clocks)});
  out.push_back({"rt_triangle_utilisation_percent", percent(rt.triangle_busy, clocks)});
  out.push_back({"rt_transform_utilisation_percent", percent(rt.transform_busy, clocks)});
  out.push_back({"rt_port_utilisation_percent", percent(rt.port_busy, clocks)});
  out.push_back({"rt_ray_slots_occupied_percent", percent(rt.occupied_slot_cycles, ray_slots)});
  out.push_back({"rt_warp_efficiency_percent", percent(working, entries)});
  out.push_back({"rt_merge_factor", ratio(rt.fetches_wanted, rt.fetches)});
  out.push_back({"sm_issue_utilisation_percent", percent(stats.sm.issued_cycles, stats.sm.issue.total())});
  out.push_back({"sm_warp_slots_occupied_percent", percent(stats.sm.occupied_slot_cycles, stats.sm.slots.total())});
  out.push_back({"simt_efficiency_percent", simt_percent(stats, stats.sm.lane_operations, stats.sm.warp_operations)});
}

void add_cache(const char* name, const CacheStats& level, std::vector<Metric>& out) {
  const uint64_t accesses = level.accesses.total();
  out.push_back({fmt::format("{}_hit_percent", name), percent(level.hits.total(), accesses)});
  for (size_t i = 0; i < request_class_count; ++i) {
    const auto c = static_cast<RequestClass>(i);
    if (level.accesses[c] == 0) continue;
    out.push_back(
        {fmt::format("{}_{}_hit_percent", name, request_class_name(c)), percent(level.hits[c], level.accesses[c])});
  }
  out.push_back({fmt::format("{}_half_miss_percent", name), percent(level.half_misses.total(), accesses)});
  out.push_back({fmt::format("{}_mshr_full", name), static_cast<double>(level.mshr_full)});
}

void add_memory(const GpuStats& stats, std::vector<Metric>& out) {
  add_cache("l1", stats.l1, out);
  add_cache("l2", stats.l2, out);
  const uint64_t bytes = (stats.dram.read_sectors.total() + stats.dram.written_sectors.total()) * sector_bytes;
  const double bytes_per_cycle = ratio(static_cast<double>(bytes), static_cast<double>(stats.cycles));
  out.push_back({"dram_bytes", static_cast<double>(bytes)});
  out.push_back({"dram_giga_bytes_per_second", bytes_per_cycle * stats.config.core_mhz * 1e-3});
  out.push_back({"dram_bandwidth_percent", 100 * ratio(bytes_per_cycle, stats.dram_peak_bytes_per_cycle)});
}

template <class State>
CycleTable table_of(const char* name, const char* unit, uint64_t total, const StateTable<State>& states) {
  CycleTable table{name, unit, total, {}};
  for (size_t i = 0; i < StateTable<State>::size; ++i)
    table.rows.push_back({state_name(static_cast<State>(i)), states.cycles[i]});
  return table;
}

}  // namespace

std::vector<Metric> metrics(const GpuStats& stats) {
  std::vector<Metric> out;
  add_rates(stats, out);
  add_units(stats, out);
  add_memory(stats, out);
  return out;
}

std::vector<CycleTable> cycle_tables(const GpuStats& stats) {
  const uint64_t sm_cycles = stats.cycles * stats.config.sm.count;
  return {
      table_of("sm_issue_slots", "issue slots x clocks", sm_cycles * stats.config.sm.sub_partitions, stats.sm.issue),
      table_of("sm_warp_slots", "warp slots x clocks", sm_cycles * stats.config.sm.warp_slots, stats.sm.slots),
      table_of("rt_ray_slots", "ray slots x clocks", sm_cycles * stats.config.rt.warp_entries * stats.warp_size,
               stats.rt.slots)};
}

std::string report_text(const GpuStats& stats) {
  std::string text;
  for (const Metric& metric : metrics(stats)) text += fmt::format("{:<36} {:>18.10g}\n", metric.name, metric.value);
  for (const CycleTable& table : cycle_tables(stats)) {
    text += fmt::format("\n{}: {} ({})\n", table.name, table.total, table.unit);
    for (const auto& [cause, cycles] : table.rows)
      text += fmt::format("  {:<24} {:>20} {:>8.3f} %\n", cause, cycles, percent(cycles, table.total));
  }
  text += fmt::format("\n{:<32} {:<16} {:>12} {:>14} {:>8}\n", "shader", "stage", "invocations", "warp_ops", "SIMT %");
  for (const NamedShaderStats& shader : stats.shaders)
    text += fmt::format("{:<32} {:<16} {:>12} {:>14} {:>8.2f}\n", shader.name, stage_name(shader.stage),
                        shader.stats.invocations, shader.stats.warp_operations,
                        simt_percent(stats, shader.stats.lane_operations, shader.stats.warp_operations));
  return text + "\nCycle-approximate and not calibrated: no substitute for measurement.\n";
}

namespace {

Json json_of(uint64_t value) { return value; }

Json json_of(const ClassCounts& counts) {
  Json json = Json::object();
  for (size_t i = 0; i < request_class_count; ++i)
    json[request_class_name(static_cast<RequestClass>(i))] = counts.values[i];
  return json;
}

template <class Stats>
Json counters(const Stats& stats) {
  Json json = Json::object();
  Stats::fields([&](const char* name, auto member) {
    using Field = std::remove_cvref_t<decltype(stats.*member)>;
    if constexpr (std::is_same_v<Field, uint64_t> || std::is_same_v<Field, ClassCounts>)
      json[name] = json_of(stats.*member);  // tables of clocks are printed as tables
  });
  return json;
}

Json tables_json(const GpuStats& stats) {
  Json json = Json::object();
  for (const CycleTable& table : cycle_tables(stats)) {
    Json rows = Json::object();
    for (const auto& [cause, cycles] : table.rows) rows[cause] = cycles;
    json[table.name] = {{"unit", table.unit}, {"total", table.total}, {"cycles", rows}};
  }
  return json;
}

Json shaders_json(const GpuStats& stats) {
  Json json = Json::array();
  for (const NamedShaderStats& shader : stats.shaders) {
    Json entry = {{"name", shader.name}, {"stage", stage_name(shader.stage)}};
    entry.update(counters(shader.stats));
    entry["simt_efficiency_percent"] = simt_percent(stats, shader.stats.lane_operations, shader.stats.warp_operations);
    json.push_back(entry);
  }
  return json;
}

}  // namespace

std::string report_json(const GpuStats& stats, const GpuPreset& preset) {
  Json json = json_document("rayloom.simulation", 1);
  json["gpu"] = Json::parse(parameter_json(preset));
  for (const Metric& metric : metrics(stats)) json["metrics"][metric.name] = metric.value;
  json["cycle_tables"] = tables_json(stats);
  json["counters"] = {{"dispatcher", counters(stats.dispatcher)},
                      {"sm", counters(stats.sm)},
                      {"rt", counters(stats.rt)},
                      {"l1", counters(stats.l1)},
                      {"l2", counters(stats.l2)},
                      {"dram", counters(stats.dram)}};
  json["shaders"] = shaders_json(stats);
  json["rays_by_depth"] = stats.rays_by_depth;
  json["sm_end_cycles"] = stats.sm_end;
  json["simulator"] = {{"events", stats.events}, {"capture_bytes", stats.capture.bytes}};
  return json_text(json);
}

std::string report_csv(const GpuStats& stats) {
  CsvTable table({"name", "value"});
  for (const Metric& metric : metrics(stats)) table.add_row({metric.name, metric.value});
  for (const CycleTable& cycles : cycle_tables(stats))
    for (const auto& [cause, value] : cycles.rows)
      table.add_row({fmt::format("{}.{}_cycles", cycles.name, cause), static_cast<unsigned long>(value)});
  return table.text();
}

}  // namespace rayloom::hwmodel
