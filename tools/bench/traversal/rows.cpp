#include <rayloom/tools/bench/traversal/rows.h>

#include <rayloom/tools/report.h>

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

// Of the table; "high robust" is the peer's watertight mode.
constexpr SpeedTarget speed_targets[] = {
    {"bounce", batch_mode, "high", 1.9, 1.5},
    {"ambient occlusion", batch_mode, "high", 1.7, 1.4},
    {"shadow", batch_mode, "high", 1.5, 1.25},
    {"bounce", batch_mode, "high robust", 2.3, 0},
    {"ambient occlusion", batch_mode, "high robust", 2.1, 0},
    {"shadow", batch_mode, "high robust", 1.9, 0},
    {"primary", batch_mode, "high", 1.05, 0.95},
    {"primary", dispatch_mode, "high", 0.7, 0},
    {"primary", single_mode, "high", 1.0, 0},
    {"bounce", single_mode, "high", 1.0, 0},
};
constexpr double full_speed_bytes = 54, minimized_bytes = 40, minimized_speed = 0.9;

Json to_json(const Differences& d) {
  return {{"total", d.total},
          {"ours_exact", d.ours_exact},
          {"theirs_exact", d.theirs_exact},
          {"ties", d.ties},
          {"undecided", d.undecided}};
}

std::string to_text(const Differences& d) {
  return fmt::format("{}: {}/{}/{}/{}", d.total, d.ours_exact, d.theirs_exact, d.ties, d.undecided);
}

Json counted(double instructions) { return instructions > 0 ? Json(instructions) : Json(); }

std::string counted_text(double instructions) { return instructions > 0 ? fmt::format("{:.0f}", instructions) : ""; }

Json to_json(const TraversalRow& row) {
  Json json{{"scene", row.scene},
            {"set", row.set},
            {"mode", row.mode},
            {"peer_call", row.peer_call},
            {"threads", row.threads},
            {"rays", row.rays},
            {"hit_share", row.hit_share},
            {"rays_per_second", to_json(row.rate)},
            {"instructions_per_ray", counted(row.instructions_per_ray)},
            {"peers", Json::array()}};
  for (const PeerRow& peer : row.peers) {
    json["peers"].push_back({{"peer", peer.peer},
                             {"rays_per_second", to_json(peer.rate)},
                             {"ratio", to_json(peer.ratio)},
                             {"differences", to_json(peer.differences)},
                             {"instructions_per_ray", counted(peer.instructions_per_ray)}});
  }
  return json;
}

std::vector<std::string> cells_of(const TraversalRow& row) {
  std::vector<std::string> cells{row.scene,
                                 row.set,
                                 row.mode,
                                 std::to_string(row.threads),
                                 fmt::format("{:.1f}", 100 * row.hit_share),
                                 bench::to_text(row.rate, 1e-6),
                                 counted_text(row.instructions_per_ray)};
  for (const PeerRow& peer : row.peers) {
    cells.push_back(fmt::format("{:.2f}", peer.rate.median * 1e-6));
    cells.push_back(bench::to_text(peer.ratio));
    cells.push_back(to_text(peer.differences));
    cells.push_back(counted_text(peer.instructions_per_ray));
  }
  return cells;
}

std::vector<double> ratios_of(const std::vector<TraversalRow>& rows, unsigned threads, const SpeedTarget& target) {
  std::vector<double> ratios;
  for (const TraversalRow& row : rows) {
    if (row.threads != threads || row.set != target.set || row.mode != target.mode) continue;
    for (const PeerRow& peer : row.peers) {
      if (peer.peer == target.peer) ratios.push_back(peer.ratio.median);
    }
  }
  return ratios;
}

void add_speed_targets(Targets& targets, const std::vector<TraversalRow>& rows, unsigned threads) {
  for (const SpeedTarget& target : speed_targets) {
    const std::vector<double> ratios = ratios_of(rows, threads, target);
    if (ratios.empty()) continue;
    const Spread spread = spread_of(ratios);
    const std::string name =
        fmt::format("{}, {}, {} threads, against Embree {}", target.set, target.mode, threads, target.peer);
    targets.at_least(name + ", median of scenes", spread.median, target.median, "x");
    if (target.smallest > 0) targets.at_least(name + ", worst scene", spread.low, target.smallest, "x");
  }
}

void add_exactness_target(Targets& targets, const std::vector<TraversalRow>& rows) {
  uint64_t wrong = 0, differences = 0;
  for (const TraversalRow& row : rows) {
    for (const PeerRow& peer : row.peers) {
      differences += peer.differences.total;
      wrong += peer.differences.theirs_exact + peer.differences.undecided;
    }
  }
  if (std::none_of(rows.begin(), rows.end(), [](const TraversalRow& row) { return !row.peers.empty(); })) return;
  targets.at_most(fmt::format("answers of ours that the oracle does not confirm, of {} differences", differences),
                  static_cast<double>(wrong), 0);
}

void add_memory_targets(Targets& targets, const std::vector<MemoryRow>& memory) {
  for (const MemoryRow& row : memory) {
    if (row.structure == "ours") {
      targets.at_most(row.scene + ": bytes per triangle at full speed", row.bytes_per_triangle(), full_speed_bytes);
    } else if (row.speed) {
      targets.at_most(row.scene + ": bytes per triangle, MINIMIZE_MEMORY", row.bytes_per_triangle(), minimized_bytes);
      targets.at_least(row.scene + ": speed of MINIMIZE_MEMORY over full speed", row.speed->median, minimized_speed,
                       "x");
    }
  }
}

}  // namespace

void add_rows(BenchReport& report, const std::vector<TraversalRow>& rows) {
  report.json["rows"] = Json::array();
  PageTable table{"traversal",
                  "Mrays/s, median (lowest to highest repetition). Differences are total: ours exact / theirs exact / "
                  "ties / undecided",
                  {{"scene", "rays", "how", "threads", "hit %", "ours", "instr/ray"}}};
  const auto widest = std::max_element(rows.begin(), rows.end(), [](const TraversalRow& a, const TraversalRow& b) {
    return a.peers.size() < b.peers.size();
  });
  if (widest != rows.end()) {
    for (const PeerRow& peer : widest->peers) {
      for (const char* column : {"", " ratio", " differences", " instr/ray"})
        table.rows[0].push_back("Embree " + peer.peer + column);
    }
  }
  for (const TraversalRow& row : rows) {
    report.json["rows"].push_back(to_json(row));
    std::vector<std::string> cells = cells_of(row);
    cells.resize(table.rows[0].size());
    table.rows.push_back(cells);
  }
  report.add_table(table);
}

void add_breakdowns(BenchReport& report, const std::vector<BreakdownRow>& rows) {
  report.json["dispatch_ns_per_ray"] = Json::array();
  PageTable table{"dispatch",
                  "Primary rays through TraceRay, ns a ray and thread",
                  {{"scene", "threads", "launch", "switches", "table lookup", "closest hit", "trace", "total"}}};
  for (const BreakdownRow& row : rows) {
    const std::pair<const char*, double> parts[]{{"launch", row.ns.launch}, {"switches", row.ns.switches},
                                                 {"lookup", row.ns.lookup}, {"closest_hit", row.ns.closest_hit},
                                                 {"trace", row.ns.trace},   {"total", row.ns.total}};
    Json json{{"scene", row.scene}, {"threads", row.threads}};
    std::vector<std::string> cells{row.scene, std::to_string(row.threads)};
    for (const auto& [name, ns] : parts) {
      json[std::string(name) + "_ns"] = ns;
      cells.push_back(fmt::format("{:.1f}", ns));
    }
    report.json["dispatch_ns_per_ray"].push_back(json);
    table.rows.push_back(cells);
  }
  report.add_table(table);
}

void add_memory(BenchReport& report, const std::vector<MemoryRow>& rows) {
  report.json["memory"] = Json::array();
  PageTable table{"memory",
                  "Memory beside the caller's vertices and indices",
                  {{"scene", "structure", "triangles", "bytes", "bytes/triangle", "bounce speed"}}};
  for (const MemoryRow& row : rows) {
    report.json["memory"].push_back({{"scene", row.scene},
                                     {"structure", row.structure},
                                     {"triangles", row.triangles},
                                     {"memory_bytes", row.bytes},
                                     {"bytes_per_triangle", row.bytes_per_triangle()},
                                     {"speed_ratio", row.speed ? to_json(*row.speed) : Json()}});
    table.rows.push_back({row.scene, row.structure, tools::with_commas(row.triangles), tools::with_commas(row.bytes),
                          fmt::format("{:.1f}", row.bytes_per_triangle()), row.speed ? to_text(*row.speed) : ""});
  }
  report.add_table(table);
}

void add_targets(Targets& targets, const std::vector<TraversalRow>& rows, const std::vector<MemoryRow>& memory) {
  std::set<unsigned> thread_counts;
  for (const TraversalRow& row : rows) thread_counts.insert(row.threads);
  for (const unsigned threads : thread_counts) add_speed_targets(targets, rows, threads);
  add_exactness_target(targets, rows);
  add_memory_targets(targets, memory);
}

}  // namespace rayloom::bench
