// Every row of the laboratory at its smallest tier.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/numerics/lab.h>

#include <atomic>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::bench::numerics;

TEST_CASE("every row passes, with something looked at") {
  for (const Row& row : all_rows()) {
    const RowResult result = run_row(row, product_subject(), Tier::quick, 1);
    CAPTURE(result.id, result.notes);
    CHECK(!result.figures.empty());
    for (const Figure& figure : result.figures) {
      CAPTURE(figure.name, figure.value, figure.cases);
      CHECK(figure.passes());
    }
    for (const FailingRay& ray : result.failing) UNSCOPED_INFO(to_line(ray));
    CHECK(result.failing.empty());
  }
}

TEST_CASE("a row's figures depend on its seed alone, not on threads") {
  const auto figures = [](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<double> values;
    for (const char* id : {"K7", "K12", "T6", "B9"})
      for (const Figure& figure : run_row(find_row(id), product_subject(), Tier::quick, 5).figures)
        values.push_back(figure.value);
    return values;
  };
  CHECK(figures(1) == figures(3));
}

TEST_CASE("a histogram keeps counts, extremes and quantiles in little memory") {
  Histogram half, whole;
  for (int i = 1; i <= 1000; ++i) (i % 2 ? half : whole).add(i);
  whole.merge(half);
  CHECK(whole.size() == 1000);
  CHECK(whole.largest() == 1000);
  CHECK(whole.quantile(1) == 1000);
  CHECK(whole.quantile(0.5) == Approx(500).epsilon(1.0 / 256));
  CHECK(whole.quantile(0.001) == Approx(1).epsilon(1.0 / 256));
  whole.add(std::nan(""));
  CHECK(std::isinf(whole.largest()));
  CHECK(Histogram().quantile(0.5) == 0);
}

TEST_CASE("a row can be watched, stopped, and its longer tiers foreseen") {
  struct Counter : Watcher {
    void begin(std::string_view row, uint64_t cases) override {
      CHECK(row == "K12");
      announced += cases;
    }
    void advance(uint64_t cases) override {
      if ((done += cases) > stop_after) throw InputError("stopped");
    }
    uint64_t announced = 0, stop_after = UINT64_MAX;
    std::atomic<uint64_t> done = 0;
  } counter, stopping;
  const RowResult result = run_row(find_row("K12"), product_subject(), Tier::quick, 1, &counter);
  CHECK(counter.announced == counter.done);
  CHECK(counter.done == 40000);
  const double nightly = expected_seconds(result, Tier::quick, Tier::nightly);
  CHECK(nightly > 1000 * result.seconds_by_growth[static_cast<size_t>(Growth::rays)]);
  CHECK(expected_seconds(result, Tier::quick, Tier::quick) == Approx(result.seconds));
  stopping.stop_after = 1000;
  CHECK_THROWS_AS(run_row(find_row("K12"), product_subject(), Tier::quick, 1, &stopping), InputError);
  CHECK(stopping.done < 40000);
}

TEST_CASE("rows and tiers have names") {
  CHECK(all_rows().size() == 40);
  CHECK(find_row("T6").id == "T6");
  CHECK_THROWS_AS(find_row("K99"), InputError);
  CHECK(parse_tier("nightly") == Tier::nightly);
  CHECK_THROWS_AS(parse_tier("weekly"), InputError);
}

TEST_CASE("a figure that is NaN, or above its limit, fails") {
  CHECK(Figure{"a", "", 1, 0, 1.0}.passes());
  CHECK_FALSE(Figure{"a", "", 1.5, 0, 1.0}.passes());
  CHECK_FALSE(Figure{"a", "", std::nan(""), 0, 1.0}.passes());
  CHECK(Figure{"a", "", 7, 0, std::nullopt}.passes());
  CHECK(Figure{"a", "rays", 0, 1000000, 0.0}.bound_per_billion() == 3000);
}
