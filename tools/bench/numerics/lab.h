#pragma once

// The numerics laboratory: one row a hazard, each with a generator, an oracle, figures and their targets. Figures are
// counts and ulps; times are for people only. The row ids are those of the plan (docs/numerics.md, "The laboratory").
//
// Oracles, three levels: O1, brute force with the exact triangle test; O2, exact rationals; O3, topology (a closed
// surface is crossed an odd number of times from inside, an even number from outside).

#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>
#include <rayloom/tools/bench/numerics/subject.h>
#include <rayloom/tools/bench/numerics/tally.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <mutex>
#include <optional>
#include <string_view>

namespace rayloom::bench::numerics {

/// How much is tried. quick is for tests: seconds; ci: minutes; nightly: 10^9 rays; release: 10^10.
enum class Tier { quick, ci, nightly, release };
std::string_view tier_name(Tier tier);
/// Throws InputError for another name.
Tier parse_tier(const std::string& name);

/// How a number of cases grows from tier to tier.
enum class Growth : uint8_t {
  fixed,  ///< not at all
  rays,   ///< as rays do that a structure or topology answers for: 10^9 of them a night
  slow,   ///< as cases do that go through rationals, brute force or builds
};
inline constexpr size_t growths = 3;
/// Cases of a tier for each one of the ci tier.
double growth_factor(Tier tier, Growth growth);

struct Cases {
  uint64_t count;
  Growth growth = Growth::fixed;

  /// A share of them, rounded up.
  Cases operator/(uint64_t parts) const { return {(count + parts - 1) / parts, growth}; }
};

/// Sees a row run; may throw to end it.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void begin(std::string_view row, uint64_t cases) = 0;  ///< before each of a row's samples
  virtual void advance(uint64_t cases) = 0;                      ///< from any thread
};

/// One number a row gives. With a limit it passes if value <= limit (NaN does not).
struct Figure {
  std::string name, unit;
  double value = 0;
  uint64_t cases = 0;           ///< what was looked at; 0: not a count of cases
  std::optional<double> limit;  ///< none: reported only

  bool passes() const { return !limit || value <= *limit; }
  /// A count of failures: its rate, and with 0 of n the 95 % bound 3 / n (rule of three), per 10^9 cases.
  double per_billion() const;
  double bound_per_billion() const;
};

struct RowResult {
  std::string id;
  std::vector<Figure> figures;
  std::vector<std::string> notes;  ///< what could not be run, what a figure means
  std::vector<FailingRay> failing;
  double seconds = 0;
  std::array<double, growths> seconds_by_growth{};  ///< adding up to `seconds`

  bool passes() const {
    return !figures.empty() && std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.passes(); });
  }
};

/// What a row's function works with.
class RowRun {
 public:
  RowRun(std::string_view id, const Subject& tested, Tier tier, uint64_t seed, Watcher* watcher);

  const Subject& subject;
  Tier tier() const { return tier_; }
  uint64_t seed() const { return seed_; }

  /// Cases for this tier, given the count of the ci tier: of cheap ones, and of those that go through rationals or
  /// builds, which grow more slowly.
  Cases rays(uint64_t ci) const;
  Cases slow(uint64_t ci) const;

  /// Runs body(random, tally) `cases` times, in parallel over fixed chunks of `grain`, each with a stream of its own.
  template <class Body>
  Tally sample(Cases cases, uint64_t grain, const Body& body) {
    Tally total;
    std::mutex mutex;
    const uint64_t part = next_part_++;
    const Timer timer(*this, cases);
    parallel_for(cases.count, grain, [&](uint64_t begin, uint64_t end) {
      Random random(stream_seed(part, begin));
      Tally tally;
      tally.cases = end - begin;
      for (tally.index = begin; tally.index < end; ++tally.index) body(random, tally);
      {
        const std::scoped_lock lock(mutex);
        total.merge(tally);
      }
      if (watcher_) watcher_->advance(end - begin);
    });
    finish(part, total);
    return total;
  }

  /// Calls body(i) for each i below `times`, one after the other.
  template <class Body>
  void repeat(Cases times, const Body& body) {
    const Timer timer(*this, times);
    for (uint64_t i = 0; i < times.count; ++i) {
      body(i);
      if (watcher_) watcher_->advance(1);
    }
  }

  /// A figure that must be 0.
  void none(const std::string& name, uint64_t failures, uint64_t cases, const std::string& unit = "rays");
  void at_most(const std::string& name, double value, const std::string& unit, double limit, uint64_t cases = 0);
  void report(const std::string& name, double value, const std::string& unit, uint64_t cases = 0);
  void note(const std::string& text) { result.notes.push_back(text); }

  RowResult result;

 private:
  /// Tells the watcher of a sample, and adds its time to the row's.
  class Timer {
   public:
    Timer(RowRun& run, Cases cases);
    ~Timer();
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

   private:
    RowRun& run_;
    Growth growth_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

  Cases grown(uint64_t ci, Growth growth) const;
  uint64_t stream_seed(uint64_t part, uint64_t begin) const;
  void finish(uint64_t part, Tally& tally);

  Tier tier_;
  uint64_t seed_;
  Watcher* watcher_;
  uint64_t next_part_ = 0;
};

struct Row {
  std::string_view id, hazard, oracle;
  void (*run)(RowRun&);
};

/// All rows in the order of the plan.
const std::vector<Row>& all_rows();
/// Throws InputError if there is none.
const Row& find_row(const std::string& id);

/// What `watcher` throws ends the row.
RowResult run_row(const Row& row, const Subject& subject, Tier tier, uint64_t seed, Watcher* watcher = nullptr);

/// Seconds that a row is likely to take in `wanted`, from what it took in `tried`.
double expected_seconds(const RowResult& result, Tier tried, Tier wanted);

}  // namespace rayloom::bench::numerics
