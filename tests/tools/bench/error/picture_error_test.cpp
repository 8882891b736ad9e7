// Pictures of known noise against references of known noise.

#include <rayloom/tools/bench/error/picture_error.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace rayloom;
using namespace rayloom::bench;

namespace {

constexpr uint32_t width = 96, height = 64;

float truth(uint32_t pixel) { return 0.2f + 0.5f * static_cast<float>(pixel % width) / width; }

/// Sums of uniform numbers: mean 0, standard deviation 1.
class Noise {
 public:
  explicit Noise(uint32_t seed) : engine_(seed) {}
  float operator()() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine_()) * 0x1p-32;
    return static_cast<float>(sum);
  }

 private:
  std::mt19937 engine_;
};

shaders::Picture noisy_picture(uint32_t seed, float deviation, float bias = 0) {
  Noise noise(seed);
  shaders::Picture picture{width, height, 1, {}, {}};
  for (uint32_t i = 0; i < width * height; ++i) {
    const auto value = [&] { return truth(i) + bias + deviation * noise(); };
    picture.rgba.emplace_back(value(), value(), value(), 1);
  }
  return picture;
}

/// Two halves, each with sqrt(2) times the deviation of their mean.
Reference noisy_reference(uint32_t seed, float deviation) {
  Reference reference{width, height, {}, {}};
  for (uint32_t h = 0; h < 2; ++h) {
    for (const auto& pixel : noisy_picture(seed + h, std::sqrt(2.0f) * deviation).rgba)
      reference.half[h].emplace_back(pixel);
  }
  reference.own_variance.assign(width * height, glm::vec3(deviation * deviation));
  return reference;
}

}  // namespace

TEST_CASE("the reference's own noise is not counted, even where it is as large as the picture's") {
  constexpr float deviation = 0.05f;
  const Reference reference = noisy_reference(100, deviation);
  const PictureError error = picture_error(noisy_picture(1, deviation), reference);
  // 18432 samples of a squared normal: the relative deviation of the mean is sqrt(2 / 18432), twice that for 2 v - v.
  CHECK(error.mse == Approx(deviation * deviation).epsilon(4 * 2 * std::sqrt(2.0 / (3 * width * height))));
  CHECK(reference_error(reference).mse == Approx(deviation * deviation));
  CHECK(reference_error(reference).relmse > reference_error(reference).mse);  // the picture is darker than 1
}

TEST_CASE("trimming leaves out one pixel of a thousand and no more") {
  const Reference reference = noisy_reference(100, 0);
  shaders::Picture picture = noisy_picture(1, 0);
  constexpr size_t trimmed = (width * height + 999) / 1000;
  const auto spoil = [&](size_t first, size_t count) {
    for (size_t i = first; i < first + count; ++i) picture.rgba[100 * i] += 10.0f;
  };
  spoil(0, trimmed);
  CHECK(picture_error(picture, reference).trimmed_relmse == Approx(0).margin(1e-9));
  CHECK(picture_error(picture, reference).relmse > 0.1);
  spoil(trimmed, 1);
  CHECK(picture_error(picture, reference).trimmed_relmse > 0.01);
}

TEST_CASE("unbiased pictures have no bias, and a bias of a tenth of the noise is found") {
  constexpr float deviation = 0.05f;
  const Reference reference = noisy_reference(100, 0.1f * deviation);
  const auto bias_of = [&](float bias) {
    SeedSpread spread;
    for (uint32_t seed = 0; seed < 8; ++seed) spread.add(noisy_picture(seed, deviation, bias));
    return spread.squared_bias(reference);
  };
  CHECK(std::abs(bias_of(0).sigmas()) < 4);
  const Bias found = bias_of(0.1f * deviation);
  CHECK(found.sigmas() > 5);
  CHECK(found.value > 0);
}

TEST_CASE("FLIP sees noise, and HDR only where a reference is brighter than white") {
  Reference reference = noisy_reference(100, 0);
  CHECK_FALSE(has_hdr(reference));
  CHECK(flip_error(noisy_picture(1, 0), reference).ldr == 0);
  CHECK(flip_error(noisy_picture(1, 0.1f), reference).ldr > flip_error(noisy_picture(1, 0.02f), reference).ldr);
  CHECK(reference_flip_error(noisy_reference(100, 0.02f)).ldr > 0);
  reference.half[0][0] = reference.half[1][0] = glm::vec3(2);
  CHECK(has_hdr(reference));
  CHECK(flip_error(noisy_picture(1, 0.1f), reference).hdr > 0);
}
