// The graph and its targets, from rows made by hand.

#include <rayloom/tools/bench/build/build_report.h>

#include <catch2/catch.hpp>

using namespace rayloom::bench;

namespace {

/// Builds a million triangles in `build_seconds`, traces a million rays in `trace_seconds`.
BuildRow row(const std::string& builder, bool ours, double build_seconds, double trace_seconds) {
  BuildRow result;
  result.scene = "hall:a=1", result.builder = builder, result.ours = ours, result.triangles = 1000000;
  result.builds = {{1, {builder, {build_seconds}, 1e6}}};
  result.trace = {builder, {trace_seconds}, 1e6};
  result.bytes = 54000000;
  return result;
}

const Target* find(const Targets& targets, const std::string& name) {
  for (const Target& target : targets.all()) {
    if (target.name == name) return &target;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("Effective rays a second tend to the build for few rays and to the trace for many") {
  const BuildRow slow_build = row("binned_sah", true, 1, 0.5);
  CHECK(slow_build.effective_rate(1e6) == Approx(1e6 / 1.5));
  CHECK(slow_build.effective_rate(1e4) == Approx(1e4).epsilon(0.01));
  CHECK(slow_build.effective_rate(1e9) == Approx(2e6).epsilon(0.01));
}

TEST_CASE("What lazy builds take is what was measured, and beyond that all parts that are left are charged for") {
  BuildRow lazy = row(lazy_builder, true, 0.2, 1);  // a million rays a second once built
  lazy.parts = 100;
  lazy.lazy_runs = {{1e4, {0.5, 0.25, 0.26}, 10}, {1e5, {0.7, 0.8, 0.9}, 50}};
  CHECK(lazy.seconds_for(1e4) == Approx(0.26));
  CHECK(lazy.seconds_for(1e5) == Approx(0.8));
  CHECK(lazy.seconds_for(5.5e4) == Approx(0.53));
  CHECK(lazy.seconds_for(5e3) == Approx(0.23));
  // Half of the parts took 0.8 - 0.2 - 0.1 seconds.
  CHECK(lazy.seconds_for(1.1e6) == Approx(0.8 + 0.5 + 1));
  CHECK(lazy.effective_rate(1e5) == Approx(1e5 / 0.8));

  BenchReport report("build", "test");
  add_builds(report, {row("binned_sah", true, 1, 1), lazy});
  CHECK(report.json["rows"][1]["lazy_runs"][1]["built_parts"] == 50);
}

TEST_CASE("The least lead is at the worst point of the envelope") {
  // Ahead in building, level in tracing.
  CHECK(least_lead({row("a", true, 0.5, 1), row("Embree low", false, 1, 1)}) == Approx(1).epsilon(0.001));
  // A second builder of ours traces twice as fast: the lead is least between the two.
  const double lead = least_lead({row("a", true, 0.5, 1), row("b", true, 4, 0.5), row("Embree low", false, 1, 1)});
  CHECK(lead > 1.05);
  CHECK(lead < 1.5);
  CHECK(least_lead({row("a", true, 2, 1), row("Embree low", false, 1, 1)}) == Approx(0.5).epsilon(0.01));
}

TEST_CASE("The chart has a line a builder from 10^4 to 10^9 rays") {
  const Chart chart = effective_rate_chart({row("binned_sah", true, 1, 1), row("Embree low", false, 1, 1)});
  CHECK(chart.name == "effective_rate_hall_a_1");
  REQUIRE(chart.series.size() == 2);
  CHECK(chart.series[0].points.front().x == Approx(1e4));
  CHECK(chart.series[1].points.back().x == Approx(1e9));
}

TEST_CASE("Targets compare the builders that are there") {
  BenchReport report("build", "test");
  add_builds(report, {row("binned_sah", true, 1, 1), row("reinsertion", true, 3, 0.8), row("lbvh", true, 0.1, 1.2),
                      row("Embree low", false, 0.3, 1.5), row("Embree medium", false, 0.9, 1.1)});
  const Target* lbvh = find(report.targets, "lbvh: build rate over Embree low, 1 threads, median of scenes");
  REQUIRE(lbvh);
  CHECK(lbvh->value == Approx(3));
  CHECK(lbvh->met());
  const Target* sah = find(report.targets, "binned_sah: build rate over Embree medium, 1 threads, median of scenes");
  REQUIRE(sah);
  CHECK_FALSE(sah->met());
  CHECK(find(report.targets, "reinsertion: trace speed over lbvh, median of scenes"));
  CHECK_FALSE(find(report.targets, "reinsertion: build rate over Embree high, 1 threads, median of scenes"));
  CHECK(report.json["rows"].size() == 5);
}
