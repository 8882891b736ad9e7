#pragma once

// Timing several things against each other: repetitions interleave, so that a change of the machine's speed meets all
// of them, and ratios are taken repetition by repetition.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace rayloom::bench {

/// Median and range of some numbers.
struct Spread {
  double low = 0, median = 0, high = 0;
};

/// The median of an even count is the mean of the middle two. Empty: all zero.
Spread spread_of(std::span<const double> values);

/// Of a[i] / b[i]: how many times b is a, each pair measured in the same repetition. Sizes must be equal.
Spread ratio_of_pairs(std::span<const double> a, std::span<const double> b);

enum class Clock {
  wall,        ///< steady time
  thread_cpu,  ///< of the calling thread: what others take from a shared core does not count
};
/// Seconds since some moment.
double now(Clock clock);

/// The time of several pieces of work together, by both clocks.
struct WorkTime {
  double wall_seconds = 0, thread_cpu_seconds = 0;

  double seconds(Clock clock) const { return clock == Clock::wall ? wall_seconds : thread_cpu_seconds; }
  template <class Work>
  void add(const Work& work) {
    const double wall = now(Clock::wall), cpu = now(Clock::thread_cpu);
    work();
    wall_seconds += now(Clock::wall) - wall;
    thread_cpu_seconds += now(Clock::thread_cpu) - cpu;
  }
};

/// One thing to time: `run` does `work` units of it (rays, triangles).
struct Measurand {
  std::string name;
  std::function<void()> run;
  double work = 1;
};

struct Measured {
  std::string name;
  std::vector<double> seconds;  ///< one a repetition
  double work = 1;

  std::vector<double> rates() const;  ///< work / seconds
  Spread rate() const { return spread_of(rates()); }
  Spread time() const { return spread_of(seconds); }
};

/// How many times faster `a` did its work than `b`.
Spread speed_ratio(const Measured& a, const Measured& b);

/// One warm-up, then `repetitions` rounds; each runs every measurand once, every other round in reverse order.
/// Progress on a terminal under `label` (empty: none). Throws Interrupted between runs after Ctrl-C.
std::vector<Measured> measure_interleaved(std::span<const Measurand> measurands, uint64_t repetitions, Clock clock,
                                          const std::string& label = {});

}  // namespace rayloom::bench
