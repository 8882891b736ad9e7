// Every row of the laboratory at its smallest tier.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/numerics/lab.h>

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
    for (const char* id : {"K7", "K12"})
      for (const Figure& figure : run_row(find_row(id), product_subject(), Tier::quick, 5).figures)
        values.push_back(figure.value);
    return values;
  };
  CHECK(figures(1) == figures(3));
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
