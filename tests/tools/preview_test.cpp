#include <rayloom/tools/preview.h>

#include <catch2/catch.hpp>
#include <limits>

using namespace rayloom::tools;

namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

}  // namespace

TEST_CASE("sRGB encoding follows IEC 61966-2-1") {
  CHECK(encode_srgb(0) == 0);
  CHECK(encode_srgb(1) == 255);
  CHECK(encode_srgb(0.5f) == 188);
  CHECK(encode_srgb(0.0031308f) == 10);
  CHECK(encode_srgb(-1) == 0);
  CHECK(encode_srgb(infinite) == 255);
  CHECK(encode_srgb(nan_value) == 0);
}

TEST_CASE("The neutral tone map keeps mid greys up to its offset and never leaves [0,1]") {
  CHECK(tone_map_neutral({0.5f, 0.5f, 0.5f})[0] == Approx(0.46));
  CHECK(tone_map_neutral({0, 0, 0})[0] == 0);
  for (const float bright : {1.0f, 10.0f, 1e10f, infinite}) {
    for (const float value : tone_map_neutral({bright, bright / 2, 0})) {
      CHECK(value >= 0);
      CHECK(value <= 1);
    }
  }
  CHECK(tone_map_neutral({100, 1, 1})[1] > 0.5f);  // very bright colours go to white
}

TEST_CASE("Exposure counts in stops") {
  const Image image{
      1, 1, {{"R", std::vector<float>{0.25f}}, {"G", std::vector<float>{0}}, {"B", std::vector<float>{2}}}, {}};
  const Preview preview = make_preview(image, ToneMap::none, 1);
  CHECK(preview.rgb == std::vector<uint8_t>{188, 0, 255});
}

TEST_CASE("A heat map goes from black to white and marks NaN") {
  const std::vector<float> values{0, 10, 20, nan_value};
  const Preview map = make_heat_map(4, 1, values, 10);
  CHECK(map.rgb == std::vector<uint8_t>{0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 255, 0});
  CHECK(make_heat_map(1, 1, std::vector<float>{0}, 0).rgb == std::vector<uint8_t>{0, 0, 0});
}

TEST_CASE("A quantile ignores what is not finite") {
  const std::vector<float> values{3, 1, infinite, 2, 4, nan_value};
  CHECK(quantile(values, 1) == 4);
  CHECK(quantile(values, 0.5) == 2);
  CHECK(quantile(values, 0) == 1);
  CHECK(quantile({}, 0.5) == 0);
}
