#include <rayloom/runtime/device.h>
#include <rayloom/shaders/environment.h>
#include <rayloom/shaders/sampler.h>
#include <rayloom/shaders/warp.h>

#include "statistics.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::shaders;
using Kind = scenes::Environment::Kind;

namespace {

/// An environment on a device, usable on this thread.
struct Sky {
  Device device;
  Buffer texels, table;
  EnvironmentView view;
  uint64_t bad = 0;
  ShaderMemoryScope scope{device};

  Sky(const scenes::Scene& scene, const scenes::Environment& e) {
    const EnvironmentTables tables = make_environment_tables(scene, e, bad);
    view = {e.kind, e.zenith, e.horizon, e.nadir, {}, {}, tables.rows, tables.columns};
    if (!tables.texels.empty()) texels = device.upload(tables.texels), view.texels = texels.structured<float3>();
    if (!tables.table.empty()) table = device.upload(tables.table), view.table = table.structured<float>();
    view.texels.count = tables.texels.size(), view.table.count = tables.table.size();
  }
};

scenes::Environment gradient() {
  scenes::Environment e;
  e.kind = Kind::gradient;
  e.zenith = {1, 2, 5}, e.horizon = {0.5f, 0.2f, 0.1f}, e.nadir = {0, 0, 0};
  return e;
}

/// 32 x 16 pixels, one very bright, some black, and one each negative, infinite and NaN.
scenes::Scene scene_with_image() {
  scenes::Pixels pixels{32, 16, {}, std::vector<float>(4 * 32 * 16)};
  for (uint32_t i = 0; i < 32 * 16; ++i) {
    Sampler sampler({i, 0}, 0, 0);
    const float4 u = sampler.next_4d();
    for (uint32_t c = 0; c < 3; ++c) pixels.floats[4 * i + c] = u.w < 0.3f ? 0.0f : u[static_cast<int>(c)];
  }
  for (uint32_t c = 0; c < 3; ++c) pixels.floats[4 * (4 * 32 + 7) + c] = 500;
  pixels.floats[40] = -1, pixels.floats[80] = INFINITY, pixels.floats[120] = NAN;
  scenes::Scene scene;
  scene.images.push_back(std::make_shared<scenes::Image>(scenes::Image::from_pixels("sky", std::move(pixels))));
  return scene;
}

scenes::Environment image() {
  scenes::Environment e;
  e.kind = Kind::image;
  return e;
}

void check_sampling(const EnvironmentView& view) {
  // Mean of 1 / pdf is the sphere's area; sampled and stated density agree; cells fill as the pdf says.
  constexpr uint32_t draws = 200000, rows = 16, columns = 32;
  std::vector<double> observed(rows * columns), expected(rows * columns);
  test::Moments sampled_light, uniform_light;
  int other_cell = 0;
  for (uint32_t i = 0; i < draws; ++i) {
    Sampler sampler({i, 9}, 0, 1);
    const DirectionSample s = sample_environment(view, sampler.next_2d());
    REQUIRE(s.pdf > 0);
    REQUIRE(std::abs(glm::length(s.direction) - 1) < 1e-5f);
    other_cell += environment_pdf(view, s.direction) != Approx(s.pdf).epsilon(1e-3);
    const double u = 0.5 + std::atan2(double(s.direction.x), -double(s.direction.z)) / (2 * M_PI);
    const auto row = std::min<uint32_t>(rows - 1, uint32_t((1 - double(s.direction.y)) / 2 * rows));
    ++observed[row * columns + std::min<uint32_t>(columns - 1, uint32_t(u * columns))];
    sampled_light.add(luminance(environment_radiance(view, s.direction)) / s.pdf);
    uniform_light.add(luminance(environment_radiance(view, uniform_sphere(sampler.next_2d()))) * 4 * M_PI);
  }
  CHECK(other_cell < 20);  // directions that rounding carries over a cell's edge
  CHECK(test::welch_p_value(sampled_light, uniform_light) > 1e-3);
  CHECK(sampled_light.variance() < uniform_light.variance());

  constexpr int refine = 24;
  for (uint32_t r = 0; r < rows * refine; ++r)
    for (uint32_t c = 0; c < columns * refine; ++c) {
      const float y = 1 - 2 * (float(r) + 0.5f) / (rows * refine), turn = (float(c) + 0.5f) / (columns * refine) - 0.5f;
      const float3 d = direction_at(y, turn);
      expected[(r / refine) * columns + c / refine] += environment_pdf(view, {d.y, y, -d.x});
    }
  double total = 0;
  for (double& e : expected) e *= 4 * M_PI / (double(rows) * columns * refine * refine), total += e;
  CHECK(total == Approx(1).epsilon(2e-3));
  // The midpoint rule is good to a few parts in a thousand a cell: compare within that.
  for (size_t i = 0; i < expected.size(); ++i) {
    const double n = expected[i] * draws;
    CHECK(std::abs(observed[i] - n) < 5 * std::sqrt(n) + 0.08 * n + 5);
  }
}

}  // namespace

TEST_CASE("a constant sky is sampled uniformly") {
  scenes::Environment e;
  e.kind = Kind::constant;
  e.zenith = {2, 3, 4};
  const Sky sky({}, e);
  CHECK(environment_radiance(sky.view, {0, 1, 0}) == float3(2, 3, 4));
  CHECK(environment_pdf(sky.view, {0, 0, 1}) == Approx(1 / (4 * M_PI)));
  CHECK(sample_environment(sky.view, {0.2f, 0.7f}).pdf == Approx(1 / (4 * M_PI)));
}

TEST_CASE("a gradient is linear in the direction's height") {
  const Sky sky({}, gradient());
  CHECK(environment_radiance(sky.view, {0, 1, 0}) == float3(1, 2, 5));
  CHECK(environment_radiance(sky.view, {1, 0, 0}) == float3(0.5f, 0.2f, 0.1f));
  CHECK(environment_radiance(sky.view, {0, -1, 0}) == float3(0));
  CHECK(environment_radiance(sky.view, {0.8f, 0.6f, 0}).y == Approx(0.2 + 0.6 * 1.8));
  check_sampling(sky.view);
}

TEST_CASE("an image is looked up by latitude and longitude and sampled by its light") {
  const scenes::Scene scene = scene_with_image();
  const Sky sky(scene, image());
  CHECK(sky.bad == 3);
  // The middle of texel (7, 4): bright.
  const float turn = (7.5f / 32 - 0.5f), y = std::cos(float(M_PI) * 4.5f / 16);
  const float3 d = direction_at(y, turn);
  CHECK(environment_radiance(sky.view, {d.y, y, -d.x}).x == Approx(500).epsilon(1e-3));
  check_sampling(sky.view);
}

TEST_CASE("without a sky there is no light") {
  const Sky sky({}, {});
  CHECK(environment_radiance(sky.view, {0, 1, 0}) == float3(0));
  CHECK(environment_pdf(sky.view, {0, 1, 0}) == 0);
}
