// rayloom bench numerics: the laboratory's rows as a table.

#include <rayloom/base/error.h>
#include <rayloom/base/progress.h>
#include <rayloom/tools/bench/bench_report.h>
#include <rayloom/tools/bench/benches.h>
#include <rayloom/tools/bench/numerics/lab.h>
#include <rayloom/tools/bench/numerics/pareto.h>
#include <rayloom/tools/cli_values.h>
#include <rayloom/tools/exit_code.h>
#include <rayloom/tools/interrupt.h>
#include <rayloom/tools/report.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::bench {
namespace {

using namespace numerics;

constexpr const char* examples =
    "  rayloom bench numerics                             every row, in under three minutes\n"
    "  rayloom bench numerics --row K1,K2 --tier nightly  two rows with 10^9 rays\n"
    "  rayloom bench numerics --check --json              exit code 1 when a figure misses its target\n"
    "  rayloom bench numerics --pareto -o out             run time against error, as a page\n";

struct NumericsOptions {
  BenchOptions bench;
  std::string tier = "ci", tested = "product", rows, record, mesh;
  uint64_t seed = 1, threads = 0;
  bool pareto = false;
};

std::vector<const Row*> chosen_rows(const std::string& names) {
  std::vector<const Row*> rows;
  if (names.empty()) {
    for (const Row& row : all_rows()) rows.push_back(&row);
  } else {
    for (const std::string& name : tools::parse_names("--row", names)) rows.push_back(&find_row(name));
  }
  return rows;
}

const Subject& parse_subject(const std::string& name) {
  if (name == "product") return product_subject();
  if (name == "plain") return plain_subject();
  throw InputError("--tested: '" + name + "' is not one of product plain");
}

/// Progress on a terminal: by rows, or in a long tier by the cases of one sample of a row after the other. Ctrl-C ends
/// the row.
class BarWatcher : public Watcher {
 public:
  BarWatcher(size_t rows, Tier tier) : rows_(rows), by_case_(tier >= Tier::nightly) {
    if (!by_case_) bar_.emplace("numerics", rows, "rows");
  }

  void begin(std::string_view row, uint64_t cases) override {
    if (by_case_) bar_.emplace(fmt::format("{} ({} of {})", row, done_ + 1, rows_), cases, "cases");
  }
  void advance(uint64_t cases) override {
    if (bar_) bar_->advance(by_case_ ? cases : 0);
    tools::throw_if_interrupted();
  }
  void finish_row() {
    ++done_;
    if (by_case_)
      bar_.reset();
    else
      bar_->advance();
  }

 private:
  size_t rows_, done_ = 0;
  bool by_case_;
  std::optional<Progress> bar_;
};

std::string duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  return seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

/// Says how long a long tier is likely to take, from a quick run of its rows.
void announce(const std::vector<const Row*>& rows, const Subject& subject, Tier tier, uint64_t seed) {
  BarWatcher watcher(rows.size(), Tier::quick);
  double seconds = 0;
  for (const Row* row : rows) {
    seconds += expected_seconds(run_row(*row, subject, Tier::quick, seed, &watcher), Tier::quick, tier);
    watcher.finish_row();
  }
  fmt::print(stderr, "rayloom: tier {} of {} rows: about {} on this machine, by a quick run of each\n", tier_name(tier),
             rows.size(), duration(seconds));
}

std::string number(double value) {
  return value == std::floor(value) && std::fabs(value) < 1e9 ? tools::with_commas(static_cast<uint64_t>(value))
                                                              : fmt::format("{:.3g}", value);
}

/// "0 of 400,000 rays (< 7.5e3 per 10^9)", "0.5 ulp"
std::string value_text(const Figure& figure) {
  const bool is_count = figure.limit == 0.0 && figure.cases > 0;
  if (!is_count) return number(figure.value) + (figure.unit.empty() ? "" : " " + figure.unit);
  return fmt::format("{} of {} {}, 95 %: < {:.2g} per 10^9", number(figure.value), tools::with_commas(figure.cases),
                     figure.unit, figure.bound_per_billion());
}

std::string limit_text(const Figure& figure) {
  if (!figure.limit) return "-";
  return (*figure.limit == 0 ? "" : "<= ") + number(*figure.limit);
}

Json to_json(const Figure& figure) {
  Json json{{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}, {"cases", figure.cases}};
  if (figure.limit) json["limit"] = *figure.limit;
  json["passes"] = figure.passes();
  return json;
}

Json to_json(const Row& row, const RowResult& result) {
  Json json{{"row", result.id}, {"hazard", row.hazard}, {"oracle", row.oracle}, {"passes", result.passes()}};
  for (const Figure& figure : result.figures) json["figures"].push_back(to_json(figure));
  for (const std::string& note : result.notes) json["notes"].push_back(note);
  for (const FailingRay& failing : result.failing) json["failing"].push_back(to_line(failing));
  json["seconds"] = result.seconds;
  return json;
}

void add_rows(PageTable& table, const Row& row, const RowResult& result) {
  for (const Figure& figure : result.figures)
    table.rows.push_back({result.id, std::string(row.hazard), figure.name, value_text(figure), limit_text(figure),
                          figure.limit ? (figure.passes() ? "ok" : "FAILED") : ""});
}

void add_targets(Targets& targets, const RowResult& result) {
  for (const Figure& figure : result.figures)
    if (figure.limit) targets.at_most(result.id + ": " + figure.name, figure.value, *figure.limit);
}

int run_pareto(const NumericsOptions& options, const tools::CommonOptions& common) {
  check_bench_output(options.bench, common);
  BenchReport report("numerics", "Run time against error");
  ParetoOptions pareto;
  pareto.seed = options.seed;
  if (parse_tier(options.tier) == Tier::quick) pareto = {20000, 5000, 500, 3, options.seed, {}};
  pareto.mesh = options.mesh;
  add_pareto(report, pareto);
  return finish_bench(report, options.bench, common);
}

int run_numerics(const NumericsOptions& options, const tools::CommonOptions& common) {
  check_bench_output(options.bench, common);
  const auto rows = chosen_rows(options.rows);
  const Tier tier = parse_tier(options.tier);
  const Subject& subject = parse_subject(options.tested);
  const ThreadLimit threads(static_cast<unsigned>(options.threads));
  if (tier >= Tier::nightly && !common.quiet) announce(rows, subject, tier, options.seed);
  BenchReport report("numerics", "The numerics laboratory");
  report.json["tier"] = options.tier;
  report.json["seed"] = options.seed;
  PageTable table{"numerics", fmt::format("Tier {}, seed {}", options.tier, options.seed), {}};
  table.rows.push_back({"row", "hazard", "figure", "seen", "target", ""});
  std::string notes;
  auto watcher = std::make_unique<BarWatcher>(rows.size(), tier);
  bool complete = true;
  for (const Row* row : rows) {
    RowResult result;
    try {
      result = run_row(*row, subject, tier, options.seed, watcher.get());
    } catch (const tools::Interrupted&) {
      if (row == rows.front()) throw;
      notes += fmt::format("interrupted: {} and the rows after it were not run\n", row->id);
      complete = false;
      break;
    }
    watcher->finish_row();
    report.json["rows"].push_back(to_json(*row, result));
    add_rows(table, *row, result);
    add_targets(report.targets, result);
    for (const std::string& note : result.notes) notes += fmt::format("{}: {}\n", result.id, note);
    for (const FailingRay& failing : result.failing) notes += "failed: " + to_line(failing) + "\n";
    if (!options.record.empty() && !result.failing.empty()) append_failing_rays(options.record, result.failing);
  }
  watcher.reset();
  report.json["complete"] = complete;
  report.add_table(table);
  report.text += notes;
  if (!notes.empty()) report.page.add_text(notes);
  const int code = finish_bench(report, options.bench, common);
  return complete ? code : tools::exit_interrupted;
}

}  // namespace

void add_bench_numerics(CLI::App& bench, tools::CommonOptions& common, tools::Action& action) {
  const auto options = std::make_shared<NumericsOptions>();
  CLI::App* sub =
      tools::add_subcommand(bench, "numerics",
                            "Look for rays that the hit tests, boxes, transforms, spawn points and builders "
                            "get wrong, against exact oracles. Figures are counts and ulps.",
                            examples, common);
  sub->add_option("--tier", options->tier, "ci (minutes), nightly (10^9 rays) or release (10^10)")->type_name("NAME");
  sub->add_option("--row", options->rows, "Rows to run, by id: K3,T6")->type_name("IDS");
  sub->add_option("--tested", options->tested,
                  "product, or plain: a float tracer that the rows must find at fault (see --check)")
      ->type_name("NAME");
  sub->add_flag("--pareto", options->pareto, "Run time against error instead, ours and Embree's");
  sub->add_option("--mesh", options->mesh, "With --pareto: only this mesh (sphere, torus ...)")->type_name("NAME");
  sub->add_option("--record", options->record, "Append every failing ray to this file")->type_name("FILE");
  tools::add_count(*sub, "--seed", options->seed, 0, UINT64_MAX, "Of all random numbers");
  tools::add_count(*sub, "--threads", options->threads, 0, 1024, "Threads, 0 for one a core");
  add_bench_options(*sub, options->bench);
  sub->callback([=, &common, &action] {
    action = [=, &common] { return options->pareto ? run_pareto(*options, common) : run_numerics(*options, common); };
  });
}

}  // namespace rayloom::bench
