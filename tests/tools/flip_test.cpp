// The FLIP metric: means as the authors' program gives them for pairs of pictures outside the repository (the directory
// named by RAYLOOM_SHARED_FLIP, else ../shared/flip; without them the case says so and checks nothing), and what must
// hold of any pictures.

#include <rayloom/base/det_math.h>
#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>
#include <rayloom/tools/flip.h>
#include <rayloom/tools/flip_color.h>
#include <rayloom/tools/flip_contrast.h>
#include <rayloom/tools/flip_error.h>
#include <rayloom/tools/flip_features.h>
#include <rayloom/tools/image_io.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <numeric>

using namespace rayloom;
using namespace rayloom::tools;

namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

std::string directory() {
  const char* named = std::getenv("RAYLOOM_SHARED_FLIP");
  return named ? named : RAYLOOM_SHARED_FLIP_DEFAULT;
}

struct Known {
  const char *reference, *test;
  FlipMode mode;
  double mean;
};

const Known known_pairs[] = {{"reference.png", "noisy.png", FlipMode::ldr, 0.107124},
                             {"reference.png", "filtered.png", FlipMode::ldr, 0.079007},
                             {"reference.png", "reference.png", FlipMode::ldr, 0},
                             {"hdr_reference.exr", "hdr_noisy.exr", FlipMode::hdr, 0.211150}};

/// A hash of the position, in [0,1): a picture without structure and without a random generator.
float hash(uint32_t x, uint32_t y, uint32_t c) {
  uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ c * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  return static_cast<float>((h ^ (h >> 13)) >> 8) * 0x1p-24f;
}

/// f(x, y, c) in channels R, G, B.
template <class Function>
Image make_image(uint32_t width, uint32_t height, Function&& f) {
  Image image{width, height, {}, {}};
  for (uint32_t c = 0; c < 3; ++c) {
    std::vector<float> values;
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) values.push_back(f(x, y, c));
    }
    image.channels.push_back({std::string(1, "RGB"[c]), std::move(values)});
  }
  return image;
}

Image noise(uint32_t width, uint32_t height, uint32_t seed, float scale = 1) {
  return make_image(width, height,
                    [=](uint32_t x, uint32_t y, uint32_t c) { return scale * hash(x, y, c + 3 * seed); });
}

Image grey(uint32_t width, uint32_t height, float value) {
  return make_image(width, height, [=](uint32_t, uint32_t, uint32_t) { return value; });
}

FlipResult compute(const Image& x, const Image& r, FlipMode mode = FlipMode::ldr) {
  return compute_flip(x, "x.exr", r, "r.exr", {mode});
}

flip::Plane noise_plane(uint32_t width, uint32_t height, uint32_t seed) {
  flip::Plane plane(width, height);
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) plane.row(y)[x] = hash(x, y, seed);
  }
  return plane;
}

/// A value with the edge repeated beyond it.
double value_at(const flip::Plane& plane, int x, int y) {
  const int w = static_cast<int>(plane.width), h = static_cast<int>(plane.height);
  return static_cast<double>(
      plane.row(static_cast<uint32_t>(std::clamp(y, 0, h - 1)))[static_cast<uint32_t>(std::clamp(x, 0, w - 1))]);
}

/// The definition: every pixel of the square around (x, y), weighted by f(dx, dy); positive weights add up to 1 and
/// negative ones to -1.
template <class Function>
double convolve_directly(const flip::Plane& in, int x, int y, int radius, Function&& f) {
  double sum[2] = {0, 0}, weights[2] = {0, 0};
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const double weight = f(static_cast<double>(dx), static_cast<double>(dy));
      sum[weight < 0] += weight * value_at(in, x + dx, y + dy);
      weights[weight < 0] += std::abs(weight);
    }
  }
  return sum[0] / weights[0] + (weights[1] > 0 ? sum[1] / weights[1] : 0);
}

template <class Function>
void require_same(const flip::Plane& plane, Function&& expected) {
  for (uint32_t y = 0; y < plane.height; ++y) {
    for (uint32_t x = 0; x < plane.width; ++x) {
      CAPTURE(x, y);
      REQUIRE(static_cast<double>(plane.row(y)[x]) ==
              Approx(expected(static_cast<int>(x), static_cast<int>(y))).margin(2e-6));
    }
  }
}

bool in_unit_interval(const flip::Plane& map) {
  return std::all_of(map.values.begin(), map.values.end(), [](float v) { return v >= 0 && v <= 1; });
}

}  // namespace

TEST_CASE("FLIP means are those of the authors' program") {
  for (const auto& [reference, test, mode, mean] : known_pairs) {
    const std::string r = directory() + "/" + reference, x = directory() + "/" + test;
    if (!std::filesystem::exists(r) || !std::filesystem::exists(x)) {
      std::cerr << "skipped: " << r << " or " << x << " is not there\n";
      continue;
    }
    CAPTURE(reference, test);
    const FlipResult result = compute_flip(read_image(x), x, read_image(r), r, {});
    CHECK(result.mode == mode);
    CHECK(std::abs(result.mean - mean) < 1e-4);
    CHECK(in_unit_interval(result.map));
    if (mode != FlipMode::hdr) continue;
    CHECK(std::abs(result.exposures.start - -1.1762) < 1e-4);
    CHECK(std::abs(result.exposures.stop - 3.9862) < 1e-4);
    CHECK(result.exposures.count == 6);
  }
}

TEST_CASE("FLIP of a picture with itself is 0") {
  const Image image = noise(40, 30, 1, 4);
  for (const FlipMode mode : {FlipMode::ldr, FlipMode::hdr}) {
    const FlipResult result = compute(image, image, mode);
    CHECK(result.mean == 0);
    CHECK(*std::max_element(result.map.values.begin(), result.map.values.end()) == 0);
  }
}

TEST_CASE("FLIP lies in [0,1] and LDR-FLIP does not mind the order of the pictures") {
  const Image a = noise(40, 30, 1), b = noise(40, 30, 2);
  const FlipResult ab = compute(a, b), ba = compute(b, a), hdr = compute(a, b, FlipMode::hdr);
  CHECK(ab.mean > 0);
  CHECK(ab.map.values == ba.map.values);
  CHECK(in_unit_interval(ab.map));
  CHECK(in_unit_interval(hdr.map));
}

TEST_CASE("Green against blue is the largest colour error") {
  const auto plain = [](uint32_t channel) {
    return make_image(8, 8, [=](uint32_t, uint32_t, uint32_t c) { return c == channel ? 1.0f : 0.0f; });
  };
  CHECK(compute(plain(1), plain(2)).mean == Approx(1).epsilon(1e-5));
  CHECK(compute(plain(0), plain(2)).mean < 0.999);
  CHECK(compute(grey(8, 8, 0), grey(8, 8, 1)).mean < 0.999);
}

TEST_CASE("A larger difference has a larger FLIP value") {
  const Image reference = noise(48, 48, 1, 0.5f);
  for (const FlipMode mode : {FlipMode::ldr, FlipMode::hdr}) {
    double last = 0;
    for (const float amount : {0.01f, 0.05f, 0.2f, 0.5f}) {
      Image x = reference;
      for (Channel& channel : x.channels) {
        for (float& value : std::get<0>(channel.values)) value += amount;
      }
      const double mean = compute(x, reference, mode).mean;
      CHECK(mean > last);
      last = mean;
    }
  }
}

TEST_CASE("Plain greys differ by the formula") {
  // No edges: the error is the redistributed power of the difference of lightness, here worked out by hand in double.
  const auto lightness = [](double y) { return 116 * std::cbrt(y) - 16; };
  const double power = std::pow(lightness(0.4) - lightness(0.2), 0.7);
  const double largest = static_cast<double>(flip::hyab(flip::to_hunt_lab({0, 1, 0}), flip::to_hunt_lab({0, 0, 1})));
  const double bend = 0.4 * std::pow(largest, 0.7);
  REQUIRE(power < bend);
  CHECK(compute(grey(5, 5, 0.4f), grey(5, 5, 0.2f)).mean == Approx(0.95 * power / bend).epsilon(1e-4));
}

TEST_CASE("Colours go to the opponent space and back") {
  for (uint32_t i = 0; i < 100; ++i) {
    const flip::Color rgb{hash(i, 0, 0), hash(i, 0, 1), hash(i, 0, 2)};
    const flip::Color back = flip::from_ycxcz(flip::to_ycxcz(rgb));
    for (size_t c = 0; c < 3; ++c) CHECK(back[c] == Approx(rgb[c]).margin(2e-6));
  }
  const flip::Color white = flip::to_ycxcz({1, 1, 1}), lab = flip::to_hunt_lab({1, 1, 1});
  CHECK(white[0] == Approx(100));
  CHECK(white[1] == Approx(0).margin(1e-4));
  CHECK(white[2] == Approx(0).margin(1e-4));
  CHECK(lab[0] == Approx(100));
  CHECK(flip::luminance({0, 1, 0}) == Approx(0.7152).epsilon(1e-3));
  CHECK(flip::decode_srgb(0.5f) == Approx(0.21404114f).epsilon(1e-5));
}

TEST_CASE("Separable contrast filters equal direct convolution") {
  // 12 pixels per degree: radius 2, a picture larger than that and one smaller than the filter.
  for (const auto& [width, height] : {std::pair{17u, 13u}, std::pair{3u, 2u}, std::pair{1u, 1u}}) {
    const double ppd = 12;
    const int radius = flip::contrast_radius(ppd);
    REQUIRE(radius == 2);
    const flip::Planes in{noise_plane(width, height, 0), noise_plane(width, height, 1), noise_plane(width, height, 2)};
    const flip::Planes out = flip::filter_contrast(in, ppd);
    const auto gaussian = [&](const flip::Gaussian& g, double dx, double dy) {
      return g.a * std::sqrt(M_PI / g.b) * std::exp(-M_PI * M_PI * (dx * dx + dy * dy) / (ppd * ppd * g.b));
    };
    const auto expect = [&](size_t c, auto weight) {
      require_same(out[c], [&](int x, int y) { return convolve_directly(in[c], x, y, radius, weight); });
    };
    expect(0, [&](double dx, double dy) { return gaussian({1, 0.0047}, dx, dy); });
    expect(1, [&](double dx, double dy) { return gaussian({1, 0.0053}, dx, dy); });
    expect(2, [&](double dx, double dy) { return gaussian({34.1, 0.04}, dx, dy) + gaussian({13.5, 0.025}, dx, dy); });
  }
}

TEST_CASE("Separable feature detectors equal direct convolution") {
  for (const auto& [width, height] : {std::pair{17u, 13u}, std::pair{2u, 4u}, std::pair{1u, 1u}}) {
    const double ppd = 30, deviation = 0.5 * 0.082 * ppd;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    REQUIRE(radius == 4);
    const flip::Plane in = noise_plane(width, height, 7);
    const flip::Features features = flip::detect_features(in, ppd);
    const auto gauss = [&](double dx, double dy) {
      return std::exp(-(dx * dx + dy * dy) / (2 * deviation * deviation));
    };
    const auto edge = [&](double dx, double dy) { return -dx * gauss(dx, dy); };
    const auto point = [&](double dx, double dy) { return (dx * dx / (deviation * deviation) - 1) * gauss(dx, dy); };
    const auto magnitude = [&](auto weight) {
      return [&in, weight, radius](int x, int y) {
        const double along = convolve_directly(in, x, y, radius, weight);
        const auto turned = [&](double dx, double dy) { return weight(dy, dx); };
        return std::hypot(along, convolve_directly(in, x, y, radius, turned));
      };
    };
    require_same(features.edges, magnitude(edge));
    require_same(features.points, magnitude(point));
  }
}

TEST_CASE("Pictures smaller than the filters are compared too") {
  for (const auto& [width, height] : {std::pair{1u, 1u}, std::pair{2u, 1u}, std::pair{1u, 9u}, std::pair{5u, 3u}}) {
    CAPTURE(width, height);
    for (const FlipMode mode : {FlipMode::ldr, FlipMode::hdr}) {
      const FlipResult result = compute(noise(width, height, 1), noise(width, height, 2), mode);
      CHECK(result.map.values.size() == size_t{width} * height);
      CHECK(in_unit_interval(result.map));
      CHECK(result.mean > 0);
    }
  }
}

TEST_CASE("The ACES curve") {
  CHECK(flip::tone_map_aces(0) == 0);
  // Narkowicz's curve (2.51 u + 0.03) u / ((2.43 u + 0.59) u + 0.14) at u = 0.6.
  CHECK(flip::tone_map_aces(1) == Approx(0.9216 / 1.3688));
  CHECK(flip::tone_map_aces(infinite) == 1);
  float last = 0;
  for (float x = 1.0f / 64; x < 4; x *= 1.25f) {
    CHECK(flip::tone_map_aces(x) > last);
    last = flip::tone_map_aces(x);
  }
}

TEST_CASE("Exposures take the brightest and the median pixel to 85 % of white") {
  const auto planes = [](const std::vector<float>& values) {
    flip::Plane plane(static_cast<uint32_t>(values.size()), 1);
    plane.values = values;
    return flip::Planes{plane, plane, plane};
  };
  const flip::Exposures e = flip::choose_exposures(planes({64, 2, 0, infinite, 0.25f, 8}));
  CHECK(e.count == 5);
  CHECK(flip::tone_map_aces(64 * det::exp2(static_cast<float>(e.start))) == Approx(0.85).epsilon(1e-5));
  CHECK(flip::tone_map_aces(2 * det::exp2(static_cast<float>(e.stop))) == Approx(0.85).epsilon(1e-5));
  CHECK(e.at(0) == e.start);
  CHECK(e.at(4) == Approx(e.stop));
  const flip::Exposures even = flip::choose_exposures(planes({1, 3, 5, 9}));
  CHECK(even.stop - even.start == Approx(std::log2(9.0 / 4)).epsilon(1e-5));
  CHECK(even.count == 2);
  CHECK(flip::choose_exposures(planes({0, 0, 0, 1})).count == 16);
  CHECK(flip::choose_exposures(planes({0, 0})).count == 1);
  CHECK(flip::choose_exposures(planes({infinite})).count == 1);
}

TEST_CASE("HDR-FLIP is the worst of its exposures and sees what LDR clips") {
  const Image bright = grey(6, 6, 8), brighter = grey(6, 6, 16);
  CHECK(compute(brighter, bright, FlipMode::ldr).mean == 0);
  const FlipResult hdr = compute(brighter, bright, FlipMode::hdr);
  CHECK(hdr.mean > 0.05);
  CHECK(hdr.exposures.count == 2);
}

TEST_CASE("Bad samples are counted and never make the map bad") {
  const Image reference = grey(30, 1, 0.5f);
  for (const float bad : {nan_value, infinite, -infinite}) {
    for (const FlipMode mode : {FlipMode::ldr, FlipMode::hdr}) {
      Image x = reference;
      std::get<0>(x.channels[1].values)[3] = bad;
      const FlipResult result = compute(x, reference, mode);
      CHECK(result.incomparable_pixels == 1);
      CHECK(result.map.values[3] == 1);
      CHECK(in_unit_interval(result.map));
      CHECK(compute(reference, x, mode).incomparable_pixels == 1);
      CHECK(compute(x, x, mode).incomparable_pixels == 0);
      CHECK(compute(x, x, mode).mean == 0);
    }
  }
  CHECK(compute(grey(4, 4, -7), grey(4, 4, 0), FlipMode::hdr).mean == 0);
}

TEST_CASE("Floats choose HDR, 8-bit pictures LDR, and their values are decoded") {
  Image x = grey(4, 4, 0.5f), r = grey(4, 4, 0.25f);
  CHECK(compute_flip(x, "x", r, "r", {}).mode == FlipMode::hdr);
  CHECK(compute_flip(x, "x", r, "r", {FlipMode::ldr}).mode == FlipMode::ldr);
  x.is_encoded = r.is_encoded = true;
  const FlipResult encoded = compute_flip(x, "x", r, "r", {});
  CHECK(encoded.mode == FlipMode::ldr);
  const Image linear_x = grey(4, 4, flip::decode_srgb(0.5f)), linear_r = grey(4, 4, flip::decode_srgb(0.25f));
  CHECK(encoded.map.values == compute(linear_x, linear_r).map.values);
}

TEST_CASE("FLIP needs colours") {
  const Image colors = grey(2, 2, 0.5f);
  Image depth = colors;
  depth.channels[2].name = "Z";
  CHECK_THROWS_AS(compute(depth, colors), InputError);
  CHECK_THROWS_AS(compute(colors, depth), InputError);
  Image ids = colors;
  ids.channels[0].values = std::vector<uint32_t>(4);
  CHECK_THROWS_AS(compute(ids, colors), InputError);
}

TEST_CASE("FLIP has the same bits for any number of threads") {
  const Image a = noise(200, 150, 1, 3), b = noise(200, 150, 2, 3);
  const auto run = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    return compute(a, b, FlipMode::hdr);
  };
  const FlipResult one = run(1), five = run(5);
  CHECK(one.map.values == five.map.values);
  CHECK(one.mean == five.mean);
}

TEST_CASE("The map is a picture of one channel") {
  const Image map = flip_image(compute(noise(6, 4, 1), noise(6, 4, 2)));
  CHECK(map.width == 6);
  CHECK(map.height == 4);
  REQUIRE(map.channels.size() == 1);
  CHECK(map.find("FLIP")->floats().size() == 24);
}
