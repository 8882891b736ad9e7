#include <rayloom/tools/bench/error/error_report.h>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

using Row = std::vector<std::string>;

std::string number(double value) { return fmt::format("{:.4g}", value); }

/// A value and its standard error, a column each.
void add(Row& row, const Estimate& e) {
  row.push_back(number(e.value));
  row.push_back(fmt::format("{:.2g}", e.standard_error));
}
void add_interval(Row& row, const Estimate& e) {
  for (const double value : {e.value, e.low(), e.high()}) row.push_back(fmt::format("{:.3f}", value));
}
void add(Row& row, const Spread& s) {
  for (const double value : {s.median, s.low, s.high}) row.push_back(fmt::format("{:.3f}", value));
}

std::string time_text(const TimeToError& time) {
  const char* relation[] = {"", "< ", "> "};
  return fmt::format("{}{:.3g} s", relation[static_cast<size_t>(time.kind)], time.seconds);
}

Estimate flip_ldr(const ErrorCurve& curve, size_t i) {
  return curve.mean(i, [](const Measurement& m) { return m.flip.ldr; });
}
Estimate flip_hdr(const ErrorCurve& curve, size_t i) {
  return curve.mean(i, [](const Measurement& m) { return m.flip.hdr; });
}

template <class Use>
void for_each_curve(const std::vector<SceneErrors>& scenes, const Use& use) {
  for (const SceneErrors& scene : scenes) {
    for (const ErrorCurve& curve : scene.curves) use(scene, curve);
  }
}

Row error_row(const SceneErrors& scene, const ErrorCurve& curve, size_t i) {
  const double seconds = curve.seconds(i).median;
  Row row{scene.scene, curve.configuration.name(), std::to_string(curve.spp[i])};
  add(row, curve.relmse(i));
  add(row, curve.trimmed_relmse(i));
  add(row, curve.mse(i));
  add(row, flip_ldr(curve, i));
  if (scene.hdr) {
    add(row, flip_hdr(curve, i));
  } else {
    row.insert(row.end(), {"-", "-"});
  }
  row.insert(row.end(), {number(seconds), number(curve.mse(i).value * seconds)});
  return row;
}

PageTable error_table(const std::vector<SceneErrors>& scenes) {
  PageTable table{
      "errors",
      "Errors: means over seeds, each with its standard error (se); trimmed: relMSE without the worst 0.1 %",
      {}};
  table.rows.push_back({"scene", "configuration", "spp", "relMSE", "se", "trimmed", "se", "MSE", "se", "FLIP", "se",
                        "HDR-FLIP", "se", "seconds", "MSE x s"});
  for_each_curve(scenes, [&](const SceneErrors& scene, const ErrorCurve& curve) {
    for (size_t i = 0; i < curve.spp.size(); ++i) table.rows.push_back(error_row(scene, curve, i));
  });
  return table;
}

PageTable slope_table(const std::vector<SceneErrors>& scenes) {
  PageTable table{"slopes", "Log-log slopes against samples with 95 % confidence, bias, and times to relMSE", {}};
  table.rows.push_back({"scene", "configuration", "MSE", "low", "high", "relMSE", "low", "high", "bias^2 / se"});
  for (const double target : error_targets) table.rows.front().push_back(fmt::format("to {}", target));
  for_each_curve(scenes, [&](const SceneErrors& scene, const ErrorCurve& curve) {
    Row row{scene.scene, curve.configuration.name()};
    add_interval(row, mse_slope(curve));
    add_interval(row, relmse_slope(curve));
    row.push_back(fmt::format("{:.1f}", curve.bias.sigmas()));
    for (const double target : error_targets) row.push_back(time_text(time_to_relmse(curve, target)));
    table.rows.push_back(std::move(row));
  });
  return table;
}

PageTable ratio_table(const std::vector<SceneErrors>& scenes) {
  PageTable table{
      "ratios",
      "Against the first configuration, at the most samples: errors, time, and efficiency = 1 / (error x time)",
      {}};
  table.rows.push_back({"scene", "configuration", "MSE", "se", "relMSE", "se", "trimmed", "se", "FLIP", "se", "time",
                        "low", "high", "eff. MSE", "se", "eff. trimmed", "se"});
  for_each_curve(scenes, [&](const SceneErrors& scene, const ErrorCurve& curve) {
    const CurveRatio ratio = compare(curve, scene.curves.front());
    Row row{scene.scene, curve.configuration.name()};
    for (const Estimate& error : {ratio.mse, ratio.relmse, ratio.trimmed_relmse, ratio.flip}) add(row, error);
    add(row, ratio.time);
    add(row, ratio.mse_efficiency);
    add(row, ratio.trimmed_efficiency);
    table.rows.push_back(std::move(row));
  });
  return table;
}

PageTable reference_table(const std::vector<SceneErrors>& scenes) {
  PageTable table{
      "references", "References: their own error (subtracted), and FLIP between their halves (bounds it)", {}};
  table.rows.push_back({"scene", "spp", "own relMSE", "own MSE", "FLIP", "HDR-FLIP", "from"});
  for (const SceneErrors& s : scenes) {
    table.rows.push_back({s.scene, std::to_string(s.reference_spp), number(s.reference_error.relmse),
                          number(s.reference_error.mse), number(s.reference_flip.ldr),
                          s.hdr ? number(s.reference_flip.hdr) : "-", s.reference_cached ? "file" : "rendering"});
  }
  return table;
}

/// Letters and digits of a scene's name, which may be a path.
std::string file_part(const std::string& scene) {
  std::string part = scene.substr(scene.find_last_of('/') + 1);
  for (char& c : part) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return part;
}

template <class X>
Chart error_chart(const SceneErrors& scene, const std::string& kind, const std::string& x_label, const X& x) {
  Chart chart{fmt::format("{}_{}", file_part(scene.scene), kind), scene.scene, {x_label, true}, {"relMSE", true}, {}};
  for (const ErrorCurve& curve : scene.curves) {
    Series series{curve.configuration.name(), {}, Style::line_and_points};
    for (size_t i = 0; i < curve.spp.size(); ++i) {
      const Estimate error = curve.relmse(i);
      series.points.push_back(
          {x(curve, i), error.value, error.value - error.standard_error, error.value + error.standard_error, {}});
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

void add_charts(Page& page, const SceneErrors& scene) {
  page.add_chart(error_chart(scene, "error_samples", "samples a pixel",
                             [](const ErrorCurve& curve, size_t i) { return static_cast<double>(curve.spp[i]); }));
  page.add_chart(error_chart(scene, "error_seconds", "seconds",
                             [](const ErrorCurve& curve, size_t i) { return curve.seconds(i).median; }));
}

Json to_json(const Estimate& e) {
  return {{"value", e.value}, {"standard_error", e.standard_error}, {"low", e.low()}, {"high", e.high()}};
}
Json to_json(const TimeToError& t) {
  const char* kinds[] = {"within", "before_first", "after_last"};
  return {{"kind", kinds[static_cast<size_t>(t.kind)]}, {"seconds", t.seconds}, {"spp", t.spp}};
}

Json points_to_json(const SceneErrors& scene, const ErrorCurve& curve) {
  Json points = Json::array();
  for (size_t i = 0; i < curve.spp.size(); ++i) {
    points.push_back({{"spp", curve.spp[i]},
                      {"relmse", to_json(curve.relmse(i))},
                      {"trimmed_relmse", to_json(curve.trimmed_relmse(i))},
                      {"mse", to_json(curve.mse(i))},
                      {"flip_ldr", to_json(flip_ldr(curve, i))},
                      {"flip_hdr", scene.hdr ? to_json(flip_hdr(curve, i)) : Json()},
                      {"seconds", to_json(curve.seconds(i))},
                      {"mse_seconds", curve.mse(i).value * curve.seconds(i).median}});
  }
  return points;
}

Json curve_to_json(const SceneErrors& scene, const ErrorCurve& curve) {
  const CurveRatio ratio = compare(curve, scene.curves.front());
  Json times = Json::array();
  for (const double target : error_targets) {
    Json time = to_json(time_to_relmse(curve, target));
    time["relmse"] = target;
    times.push_back(std::move(time));
  }
  return {{"sampler", shaders::name_of(curve.configuration.sampler)},
          {"estimator", estimator_names[static_cast<size_t>(curve.configuration.estimator)]},
          {"points", points_to_json(scene, curve)},
          {"mse_slope", to_json(mse_slope(curve))},
          {"relmse_slope", to_json(relmse_slope(curve))},
          {"squared_bias", {{"value", curve.bias.value}, {"standard_error", curve.bias.standard_error}}},
          {"time_to_relmse", times},
          {"against_first",
           {{"mse", to_json(ratio.mse)},
            {"relmse", to_json(ratio.relmse)},
            {"trimmed_relmse", to_json(ratio.trimmed_relmse)},
            {"flip_ldr", to_json(ratio.flip)},
            {"time", to_json(ratio.time)},
            {"mse_efficiency", to_json(ratio.mse_efficiency)},
            {"trimmed_relmse_efficiency", to_json(ratio.trimmed_efficiency)}}}};
}

Json scene_to_json(const SceneErrors& scene) {
  Json curves = Json::array();
  for (const ErrorCurve& curve : scene.curves) curves.push_back(curve_to_json(scene, curve));
  return {{"scene", scene.scene},
          {"reference",
           {{"key", scene.reference_key},
            {"spp", scene.reference_spp},
            {"cached", scene.reference_cached},
            {"own_relmse", scene.reference_error.relmse},
            {"own_mse", scene.reference_error.mse},
            {"flip_ldr_between_halves", scene.reference_flip.ldr},
            {"flip_hdr_between_halves", scene.hdr ? Json(scene.reference_flip.hdr) : Json()}}},
          {"configurations", curves}};
}

void add_targets(BenchReport& report, const SceneErrors& scene, const ErrorCurve& curve) {
  const std::string name = scene.scene + ": " + curve.configuration.name();
  const Estimate slope = mse_slope(curve);
  if (is_undetermined(slope)) {
    const std::string note = name + ": the slope is not determined: take more seeds";
    report.text += "\n" + note + "\n";
    report.page.add_text(note);
    return;
  }
  report.targets.at_most(name + ": slope of MSE", slope.value, max_slope);
  report.targets.at_most(name + ": squared bias", curve.bias.sigmas(), max_bias_sigmas, " standard errors");
}

}  // namespace

bool is_undetermined(const Estimate& mse_slope) { return mse_slope.value > max_slope && mse_slope.low() <= -1; }

void add_results(BenchReport& report, const std::vector<SceneErrors>& scenes) {
  Json list = Json::array();
  for (const SceneErrors& scene : scenes) list.push_back(scene_to_json(scene));
  report.json["scenes"] = list;
  for (const PageTable& table :
       {error_table(scenes), slope_table(scenes), ratio_table(scenes), reference_table(scenes)}) {
    report.add_table(table);
  }
  for (const SceneErrors& scene : scenes) add_charts(report.page, scene);
  for_each_curve(scenes, [&](const SceneErrors& scene, const ErrorCurve& curve) { add_targets(report, scene, curve); });
}

}  // namespace rayloom::bench
