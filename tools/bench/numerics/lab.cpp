#include <rayloom/base/error.h>
#include <rayloom/tools/bench/numerics/lab.h>

#include <chrono>

namespace rayloom::bench::numerics {
namespace {

constexpr std::string_view tier_names[] = {"quick", "ci", "nightly", "release"};

struct Growth {
  double rays, slow;
};
constexpr Growth growth[] = {{0.02, 0.05}, {1, 1}, {250, 20}, {2500, 100}};

uint64_t scaled(uint64_t ci, double factor) {
  return std::max<uint64_t>(1, static_cast<uint64_t>(static_cast<double>(ci) * factor));
}

}  // namespace

std::string_view tier_name(Tier tier) { return tier_names[static_cast<size_t>(tier)]; }

Tier parse_tier(const std::string& name) {
  for (const Tier tier : {Tier::quick, Tier::ci, Tier::nightly, Tier::release})
    if (name == tier_name(tier)) return tier;
  throw InputError("--tier: '" + name + "' is not one of quick ci nightly release");
}

double Figure::per_billion() const { return cases ? 1e9 * value / static_cast<double>(cases) : 0; }

double Figure::bound_per_billion() const {
  if (cases == 0) return 0;
  const double failures = value > 0 ? value + 2 * std::sqrt(value) + 2 : 3;
  return 1e9 * failures / static_cast<double>(cases);
}

RowRun::RowRun(std::string_view id, const Subject& tested, Tier tier, uint64_t seed)
    : subject(tested), tier_(tier), seed_(seed) {
  result.id = id;
}

uint64_t RowRun::rays(uint64_t ci) const { return scaled(ci, growth[static_cast<size_t>(tier_)].rays); }
uint64_t RowRun::slow(uint64_t ci) const { return scaled(ci, growth[static_cast<size_t>(tier_)].slow); }

uint64_t RowRun::stream_seed(uint64_t part, uint64_t begin) const {
  Hash64 hash(seed_);
  for (const char c : result.id) hash.add(static_cast<uint8_t>(c));
  return hash.add(part).add(begin).value();
}

void RowRun::finish(uint64_t part, Tally& tally) {
  std::sort(tally.values.begin(), tally.values.end());
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

RowResult run_row(const Row& row, const Subject& subject, Tier tier, uint64_t seed) {
  const auto start = std::chrono::steady_clock::now();
  RowRun run(row.id, subject, tier, seed);
  row.run(run);
  run.result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return run.result;
}

}  // namespace rayloom::bench::numerics
