#include <rayloom/base/error.h>
#include <rayloom/tools/bench/numerics/lab.h>

#include <chrono>

namespace rayloom::bench::numerics {
namespace {

constexpr std::string_view tier_names[] = {"quick", "ci", "nightly", "release"};

/// Of the tiers, by Growth.
constexpr double factors[][growths] = {{1, 0.01, 0.05}, {1, 1, 1}, {1, 100, 20}, {1, 1000, 100}};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::string_view tier_name(Tier tier) { return tier_names[static_cast<size_t>(tier)]; }

Tier parse_tier(const std::string& name) {
  for (const Tier tier : {Tier::quick, Tier::ci, Tier::nightly, Tier::release})
    if (name == tier_name(tier)) return tier;
  throw InputError("--tier: '" + name + "' is not one of quick ci nightly release");
}

double growth_factor(Tier tier, Growth growth) {
  return factors[static_cast<size_t>(tier)][static_cast<size_t>(growth)];
}

double Figure::per_billion() const { return cases ? 1e9 * value / static_cast<double>(cases) : 0; }

double Figure::bound_per_billion() const {
  if (cases == 0) return 0;
  const double failures = value > 0 ? value + 2 * std::sqrt(value) + 2 : 3;
  return 1e9 * failures / static_cast<double>(cases);
}

RowRun::RowRun(std::string_view id, const Subject& tested, Tier tier, uint64_t seed, Watcher* watcher)
    : subject(tested), tier_(tier), seed_(seed), watcher_(watcher) {
  result.id = id;
}

Cases RowRun::rays(uint64_t ci) const { return grown(ci, Growth::rays); }
Cases RowRun::slow(uint64_t ci) const { return grown(ci, Growth::slow); }

Cases RowRun::grown(uint64_t ci, Growth growth) const {
  const double count = static_cast<double>(ci) * growth_factor(tier_, growth);
  return {std::max<uint64_t>(1, static_cast<uint64_t>(count)), growth};
}

RowRun::Timer::Timer(RowRun& run, Cases cases) : run_(run), growth_(cases.growth) {
  if (run.watcher_) run.watcher_->begin(run.result.id, cases.count);
}
RowRun::Timer::~Timer() { run_.result.seconds_by_growth[static_cast<size_t>(growth_)] += seconds_since(start_); }

uint64_t RowRun::stream_seed(uint64_t part, uint64_t begin) const {
  Hash64 hash(seed_);
  for (const char c : result.id) hash.add(static_cast<uint8_t>(c));
  return hash.add(part).add(begin).value();
}

void RowRun::finish(uint64_t part, Tally& tally) {
  for (FailingRay& failing : tally.examples) {
    failing.row = result.id;
    failing.seed = seed_;
    failing.part = part;
    if (result.failing.size() < 4 * Tally::most_examples) result.failing.push_back(failing);
  }
}

void RowRun::none(const std::string& name, uint64_t failures, uint64_t cases, const std::string& unit) {
  result.figures.push_back({name, unit, static_cast<double>(failures), cases, 0.0});
}

void RowRun::at_most(const std::string& name, double value, const std::string& unit, double limit, uint64_t cases) {
  result.figures.push_back({name, unit, value, cases, limit});
}

void RowRun::report(const std::string& name, double value, const std::string& unit, uint64_t cases) {
  result.figures.push_back({name, unit, value, cases, std::nullopt});
}

const Row& find_row(const std::string& id) {
  for (const Row& row : all_rows())
    if (row.id == id) return row;
  throw InputError("--row: there is no row '" + id + "'");
}

RowResult run_row(const Row& row, const Subject& subject, Tier tier, uint64_t seed, Watcher* watcher) {
  const auto start = std::chrono::steady_clock::now();
  RowRun run(row.id, subject, tier, seed, watcher);
  row.run(run);
  RowResult& result = run.result;
  result.seconds = seconds_since(start);
  auto& [fixed, rays, slow] = result.seconds_by_growth;
  fixed = std::max(0.0, result.seconds - rays - slow);
  return result;
}

double expected_seconds(const RowResult& result, Tier tried, Tier wanted) {
  double seconds = 0;
  for (const Growth growth : {Growth::fixed, Growth::rays, Growth::slow})
    seconds += result.seconds_by_growth[static_cast<size_t>(growth)] * growth_factor(wanted, growth) /
               growth_factor(tried, growth);
  return seconds;
}

}  // namespace rayloom::bench::numerics
