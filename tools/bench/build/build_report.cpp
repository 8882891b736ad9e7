#include <rayloom/tools/bench/build/build_report.h>

#include <rayloom/tools/report.h>

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

constexpr const char *sah = "binned_sah", *fast_trace = "reinsertion", *morton = "lbvh", *treelets = "lbvh_treelets";

double bytes_per_triangle(const BuildRow& row) {
  return static_cast<double>(row.bytes) / static_cast<double>(row.triangles);
}

Json to_json(const BuildRow& row) {
  Json json{{"scene", row.scene}, {"builder", row.builder}, {"ours", row.ours}, {"triangles", row.triangles}};
  for (const auto& [threads, measured] : row.builds) {
    json["builds"].push_back({{"threads", threads},
                              {"seconds", to_json(measured.time())},
                              {"triangles_per_second", to_json(measured.rate())}});
  }
  json["sah_cost"] = row.shape ? Json(row.shape->sah_cost) : Json();
  json["depth_nodes"] = row.shape ? Json(row.shape->depth) : Json();
  json["children_per_node"] = row.shape ? Json(row.shape->children_per_node) : Json();
  json["memory_bytes"] = row.bytes;
  json["bytes_per_triangle"] = bytes_per_triangle(row);
  json["rays_per_second"] = to_json(row.trace.rate());
  for (const LazyRun& run : row.lazy_runs) {
    json["lazy_runs"].push_back({{"rays", run.rays},
                                 {"seconds", to_json(spread_of(run.seconds))},
                                 {"built_parts", run.built_parts},
                                 {"parts", row.parts}});
  }
  return json;
}

std::vector<std::string> table_header(const BuildRow& row) {
  std::vector<std::string> header{"scene", "builder"};
  for (const auto& build : row.builds) header.push_back(fmt::format("Mtris/s, {} threads", build.first));
  for (const char* name : {"SAH", "depth", "children", "bytes/tri", "Mrays/s"}) header.push_back(name);
  return header;
}

std::vector<std::string> table_row(const BuildRow& row) {
  std::vector<std::string> cells{row.scene, row.builder};
  for (const auto& build : row.builds) cells.push_back(to_text(build.second.rate(), 1e-6));
  const auto shape = [&](const std::string& text) { return row.shape ? text : std::string(); };
  cells.push_back(shape(fmt::format("{:.2f}", row.shape ? row.shape->sah_cost : 0)));
  cells.push_back(shape(std::to_string(row.shape ? row.shape->depth : 0)));
  cells.push_back(shape(fmt::format("{:.2f}", row.shape ? row.shape->children_per_node : 0)));
  cells.push_back(fmt::format("{:.1f}", bytes_per_triangle(row)));
  cells.push_back(to_text(row.trace.rate(), 1e-6));
  return cells;
}

const BuildRow* find(const std::vector<BuildRow>& rows, std::string_view builder) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const BuildRow& row) { return row.builder == builder; });
  return found == rows.end() ? nullptr : &*found;
}

/// What lazy builds took for the first rays, beside the best that is not lazy.
PageTable lazy_table(const std::vector<std::vector<BuildRow>>& scenes) {
  PageTable table{
      "lazy",
      "Lazy builds and their first rays, which build the parts they come to; one thread",
      {{"scene", "rays", "parts built", "build + trace, ms", "effective Mrays/s", "best other, Mrays/s", ""}}};
  for (const auto& rows : scenes) {
    const BuildRow* const lazy = find(rows, lazy_builder);
    if (!lazy) continue;
    for (const LazyRun& run : lazy->lazy_runs) {
      const BuildRow* best = nullptr;
      for (const BuildRow& row : rows)
        if (row.ours && &row != lazy && (!best || row.effective_rate(run.rays) > best->effective_rate(run.rays)))
          best = &row;
      const double share = static_cast<double>(run.built_parts) / static_cast<double>(lazy->parts);
      table.rows.push_back(
          {lazy->scene, fmt::format("{:.0f}", run.rays),
           fmt::format("{} of {} ({:.0f} %)", run.built_parts, lazy->parts, 100 * share),
           to_text(spread_of(run.seconds), 1e3), fmt::format("{:.3f}", 1e-6 * lazy->effective_rate(run.rays)),
           fmt::format("{:.3f}", best ? 1e-6 * best->effective_rate(run.rays) : 0), best ? best->builder : ""});
    }
  }
  return table;
}

/// Ratios of one scene that targets bound, by the target's name.
using Ratios = std::map<std::string, std::pair<double, double>>;  // value, bound

void add_build_ratios(Ratios& ratios, const std::vector<BuildRow>& rows, const char* ours, const char* theirs,
                      double bound) {
  const BuildRow *a = find(rows, ours), *b = find(rows, theirs);
  if (!a || !b) return;
  for (const auto& [threads, measured] : a->builds) {
    const Measured* other = b->built_with(threads);
    ratios[fmt::format("{}: build rate over {}, {} threads", ours, theirs, threads)] = {
        speed_ratio(measured, *other).median, bound};
  }
}

void add_trace_ratio(Ratios& ratios, const std::vector<BuildRow>& rows, const char* ours, const std::string& other,
                     double bound) {
  const BuildRow *a = find(rows, ours), *b = find(rows, other);
  if (!a || !b || a == b) return;
  ratios[fmt::format("{}: trace speed over {}", ours, other)] = {speed_ratio(a->trace, b->trace).median, bound};
}

Ratios ratios_of(const std::vector<BuildRow>& rows) {
  Ratios ratios;
  add_build_ratios(ratios, rows, morton, "Embree low", 2);
  add_build_ratios(ratios, rows, sah, "Embree medium", 1);
  add_build_ratios(ratios, rows, fast_trace, "Embree high", 1);
  add_build_ratios(ratios, rows, treelets, sah, 1);
  add_trace_ratio(ratios, rows, treelets, sah, 0.95);
  for (const BuildRow& row : rows) {
    if (row.ours) add_trace_ratio(ratios, rows, fast_trace, row.builder, 1);
  }
  if (find(rows, "Embree low"))
    ratios["graph: our best over Embree's best, where the lead is least"] = {least_lead(rows), 1};
  return ratios;
}

std::vector<std::vector<BuildRow>> by_scene(const std::vector<BuildRow>& rows) {
  std::vector<std::vector<BuildRow>> scenes;
  for (const BuildRow& row : rows) {
    if (scenes.empty() || scenes.back().front().scene != row.scene) scenes.emplace_back();
    scenes.back().push_back(row);
  }
  return scenes;
}

/// Medians over the scenes.
void add_targets(Targets& targets, const std::vector<std::vector<BuildRow>>& scenes) {
  std::map<std::string, std::pair<std::vector<double>, double>> values;
  for (const auto& rows : scenes) {
    for (const auto& [name, ratio] : ratios_of(rows)) {
      values[name].first.push_back(ratio.first);
      values[name].second = ratio.second;
    }
  }
  for (const auto& [name, value] : values) {
    targets.at_least(name + ", median of scenes", spread_of(value.first).median, value.second, "x");
  }
}

std::string file_name(const std::string& scene) {
  std::string name = "effective_rate_";
  for (const char c : scene) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

}  // namespace

Chart effective_rate_chart(const std::vector<BuildRow>& rows) {
  Chart chart{file_name(rows.front().scene),
              rows.front().scene + ": rays / (build + trace), one thread",
              {"rays traced per build", true},
              {"effective rays per second", true},
              {}};
  for (const BuildRow& row : rows) {
    Series& series =
        chart.series.emplace_back(Series{row.builder, {}, row.ours ? Style::line_and_points : Style::line});
    for (const double rays : rays_per_build()) series.points.push_back({rays, row.effective_rate(rays), 0, 0, ""});
  }
  return chart;
}

double least_lead(const std::vector<BuildRow>& rows) {
  double least = std::numeric_limits<double>::infinity();
  for (const double rays : rays_per_build()) {
    double best[2] = {0, 0};
    for (const BuildRow& row : rows) best[row.ours] = std::max(best[row.ours], row.effective_rate(rays));
    least = std::min(least, best[1] / best[0]);
  }
  return least;
}

void add_builds(BenchReport& report, const std::vector<BuildRow>& rows) {
  report.json["rows"] = Json::array();
  if (rows.empty()) return;
  PageTable table{"build",
                  "Builders, median (lowest to highest repetition); rays are bounce rays on one thread",
                  {table_header(rows.front())}};
  for (const BuildRow& row : rows) {
    report.json["rows"].push_back(to_json(row));
    table.rows.push_back(table_row(row));
  }
  report.add_table(table);
  const std::vector<std::vector<BuildRow>> scenes = by_scene(rows);
  report.add_table(lazy_table(scenes));
  for (const auto& scene : scenes) report.page.add_chart(effective_rate_chart(scene));
  add_targets(report.targets, scenes);
}

}  // namespace rayloom::bench
