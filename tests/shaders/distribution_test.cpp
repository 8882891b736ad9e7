#include <rayloom/shaders/distribution.h>
#include <rayloom/shaders/hash.h>

#include <catch2/catch.hpp>

#include <cmath>

using rayloom::shaders::append_cumulative;
using rayloom::shaders::choose;

TEST_CASE("each choice has exactly the probability the table states") {
  // Every 24-bit random number, counted.
  const std::vector<float> weights{3, 0, 1, 1e-9f, 5, 0};
  std::vector<float> table{7};  // what is there stays
  CHECK(append_cumulative(weights, table) == Approx(9));
  REQUIRE(table.size() == 8);
  CHECK(table[0] == 7);
  CHECK(table[1] == 0);
  CHECK(table.back() == 1);
  std::vector<uint64_t> count(weights.size());
  for (uint32_t i = 0; i < (1u << 24); ++i) ++count[choose(table, 1, 6, rayloom::shaders::unit_float(i << 8)).index];
  for (uint32_t i = 0; i < weights.size(); ++i) {
    CHECK(static_cast<double>(count[i]) * 0x1p-24 == double(table[i + 2]) - double(table[i + 1]));
    CHECK((count[i] > 0) == (weights[i] > 0));
  }
  CHECK(static_cast<double>(count[0]) * 0x1p-24 == Approx(3.0 / 9).margin(0x1p-23));
  CHECK(count[3] == 1);
}

TEST_CASE("many tiny weights all keep a chance") {
  std::vector<float> weights(100000, 1e-12f);
  weights[500] = 1;
  weights.push_back(0);
  std::vector<float> table;
  append_cumulative(weights, table);
  for (size_t i = 0; i + 1 < table.size(); ++i) REQUIRE((table[i + 1] > table[i]) == (weights[i] > 0));
  CHECK(table.back() == 1);
}

TEST_CASE("without any weight all are equal") {
  std::vector<float> table;
  append_cumulative(std::vector<float>(4, 0.0f), table);
  CHECK(table == std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1});
}

TEST_CASE("the offset is where u fell in its interval") {
  std::vector<float> table;
  append_cumulative(std::vector<float>{1, 3}, table);
  const auto choice = choose(table, 0, 2, 0.625f);
  CHECK(choice.index == 1);
  CHECK(choice.probability == 0.75f);
  CHECK(choice.offset == 0.5f);
}
