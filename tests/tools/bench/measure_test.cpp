// Statistics against values worked out by hand, and the order in which measurands run.

#include <rayloom/tools/bench/measure.h>
#include <rayloom/tools/bench/targets.h>

#include <limits>

#include <catch2/catch.hpp>

using namespace rayloom::bench;

TEST_CASE("Median and range of odd, even and no numbers") {
  const Spread odd = spread_of(std::vector<double>{5, 1, 3});
  CHECK(odd.low == 1);
  CHECK(odd.median == 3);
  CHECK(odd.high == 5);
  CHECK(spread_of(std::vector<double>{4, 1, 3, 2}).median == 2.5);
  CHECK(spread_of({}).median == 0);
}

TEST_CASE("Ratios are taken pair by pair, not of medians") {
  const std::vector<double> a{10, 40, 90}, b{10, 20, 30};
  const Spread ratio = ratio_of_pairs(a, b);
  CHECK(ratio.low == 1);
  CHECK(ratio.median == 2);
  CHECK(ratio.high == 3);
}

TEST_CASE("A speed ratio counts work by time") {
  const Measured a{"a", {1, 2}, 100}, b{"b", {1, 1}, 50};
  CHECK(a.rates() == std::vector<double>{100, 50});
  CHECK(speed_ratio(a, b).high == 2);
  CHECK(speed_ratio(a, b).low == 1);
  CHECK(speed_ratio(a, b).median == 1.5);
}

TEST_CASE("Measurands interleave, every other round in reverse, and the warm-up is not counted") {
  std::string order;
  const std::vector<Measurand> measurands{{"a", [&] { order += 'a'; }, 1}, {"b", [&] { order += 'b'; }, 1}};
  const std::vector<Measured> measured = measure_interleaved(measurands, 3, Clock::wall);
  CHECK(order == "abbaabba");
  REQUIRE(measured.size() == 2);
  CHECK(measured[0].name == "a");
  CHECK(measured[1].seconds.size() == 3);
}

TEST_CASE("Both clocks count seconds forwards") {
  for (const Clock clock : {Clock::wall, Clock::thread_cpu}) {
    const double begin = now(clock);
    double after = begin;
    while (after - begin < 1e-3) after = now(clock);
    CHECK(after - begin < 10);
  }
}

TEST_CASE("A target is met on its bound, and never by a NaN") {
  Targets targets;
  targets.at_least("rate", 2, 2, "x");
  targets.at_most("bytes", 54, 54);
  CHECK(targets.all_met());
  targets.at_most("error", std::numeric_limits<double>::quiet_NaN(), 1);
  CHECK_FALSE(targets.all_met());
  CHECK_THAT(targets.to_text(), Catch::Contains("met     rate: 2x, target at least 2x") &&
                                    Catch::Contains("MISSED  error: nan, target at most 1"));
  CHECK(targets.to_json()[2]["met"] == false);
}
