#include <rayloom/base/error.h>
#include <rayloom/tools/image_compare.h>

#include <catch2/catch.hpp>
#include <limits>

using namespace rayloom;
using namespace rayloom::tools;

namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

Image one_row(const std::string& name, std::vector<float> values) {
  const auto width = static_cast<uint32_t>(values.size());
  return {width, 1, {{name, std::move(values)}}, {}};
}

Comparison compare(const Image& x, const Image& r) { return compare_images(x, "x.exr", r, "r.exr"); }

}  // namespace

TEST_CASE("Error measures equal those worked out by hand") {
  // Differences 0.5, 0, -1, 3 against 0.5, 1, 2, 0.
  const Comparison c = compare(one_row("R", {1, 1, 1, 3}), one_row("R", {0.5f, 1, 2, 0}));
  CHECK(c.overall.value(Metric::mse) == (0.25 + 0 + 1 + 9) / 4);
  CHECK(c.overall.value(Metric::mae) == (0.5 + 0 + 1 + 3) / 4);
  CHECK(c.overall.value(Metric::max) == 3);
  CHECK(c.overall.value(Metric::relmse) == Approx((0.25 / 0.26 + 0 + 1 / 4.01 + 9 / 0.01) / 4).epsilon(1e-15));
  CHECK(c.overall.value(Metric::psnr) == Approx(-4.0866387).epsilon(1e-7));  // 10 log10(4 / 10.25)
  CHECK(c.overall.samples == 4);
  CHECK(c.overall.different == 3);
  CHECK(c.overall.incomparable == 0);
  CHECK_FALSE(c.bits_equal);
}

TEST_CASE("relmse scales by the reference, not by the picture") {
  CHECK(compare(one_row("R", {10}), one_row("R", {0})).overall.value(Metric::relmse) == Approx(100 / 0.01));
  CHECK(compare(one_row("R", {0}), one_row("R", {10})).overall.value(Metric::relmse) == Approx(100 / 100.01));
}

TEST_CASE("Equal pictures have no error and infinite psnr") {
  const Image image = one_row("R", {0, 1, nan_value, infinite});
  const Comparison c = compare(image, image);
  CHECK(c.overall.different == 0);
  CHECK(c.overall.value(Metric::mse) == 0);
  CHECK(c.overall.value(Metric::psnr) == std::numeric_limits<double>::infinity());
  CHECK(c.bits_equal);
}

TEST_CASE("Signed zeros are equal as numbers and differ as bits") {
  const Comparison c = compare(one_row("R", {0.0f}), one_row("R", {-0.0f}));
  CHECK(c.overall.different == 0);
  CHECK_FALSE(c.bits_equal);
}

TEST_CASE("No bound passes over a sample that is finite in one picture only") {
  const float odd = GENERATE(values({nan_value, infinite, -infinite}));
  const bool in_picture = GENERATE(true, false);
  CAPTURE(odd, in_picture);
  const Image finite = one_row("R", {1, 1}), broken = one_row("R", {1, odd});
  const Comparison c = in_picture ? compare(broken, finite) : compare(finite, broken);
  CHECK(c.overall.incomparable == 1);
  for (const Metric metric : {Metric::mse, Metric::relmse, Metric::psnr, Metric::mae, Metric::max}) {
    CHECK_FALSE(within_bound(metric, c.overall.value(metric), metric == Metric::psnr ? 0 : 1e300));
  }
}

TEST_CASE("Infinities of opposite sign differ") {
  CHECK(compare(one_row("R", {infinite}), one_row("R", {-infinite})).overall.incomparable == 1);
}

TEST_CASE("Ids are equal or not, however far apart") {
  const Image x{3, 1, {{"id.primitive", std::vector<uint32_t>{1, 2, 0xFFFFFFFFu}}}, {}};
  const Image r{3, 1, {{"id.primitive", std::vector<uint32_t>{1, 3, 0}}}, {}};
  const Comparison c = compare(x, r);
  CHECK(c.overall.different == 2);
  CHECK(c.overall.value(Metric::max) == 1);
  CHECK(c.overall.value(Metric::mse) == 2.0 / 3);
}

TEST_CASE("Channels are matched by name and reported one by one") {
  const Image x{1, 1, {{"R", std::vector<float>{1}}, {"Z", std::vector<float>{5}}}, {}};
  const Image r{1, 1, {{"Z", std::vector<float>{7}}, {"R", std::vector<float>{1}}}, {}};
  const Comparison c = compare(x, r);
  REQUIRE(c.channels.size() == 2);
  CHECK(c.channels[0].name == "Z");
  CHECK(c.channels[0].value(Metric::mse) == 4);
  CHECK(c.channels[1].value(Metric::mse) == 0);
  CHECK(c.overall.value(Metric::mse) == 2);
}

TEST_CASE("Pictures of different shape are refused") {
  const Image r = one_row("R", {1, 2});
  CHECK_THROWS_AS(compare(one_row("R", {1}), r), InputError);
  CHECK_THROWS_AS(compare(one_row("G", {1, 2}), r), InputError);
  CHECK_THROWS_AS(compare({2, 1, {}, {}}, r), InputError);
  CHECK_THROWS_AS(compare({2, 1, {{"R", std::vector<uint32_t>{1, 2}}}, {}}, r), InputError);
}

TEST_CASE("The difference image holds absolute differences") {
  const Image difference = difference_image(one_row("R", {1, 2, nan_value}), one_row("R", {3, 2, 0}));
  CHECK(difference.channels[0].floats() == std::vector<float>{2, 0, infinite});
}

TEST_CASE("A psnr bound is a lower one, the others are upper ones") {
  CHECK(within_bound(Metric::mse, 1, 1));
  CHECK_FALSE(within_bound(Metric::mse, 1.5, 1));
  CHECK(within_bound(Metric::psnr, 40, 40));
  CHECK_FALSE(within_bound(Metric::psnr, 39, 40));
  CHECK(find_metric("relmse") == Metric::relmse);
  CHECK_FALSE(find_metric("rmse"));
}
