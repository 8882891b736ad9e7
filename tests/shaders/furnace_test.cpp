// White furnace through the whole path tracer: what reflects everything, in a sky of 1, cannot be seen.

#include <rayloom/scenes/camera.h>
#include <rayloom/shaders/renderer.h>

#include "ggx_quadrature.h"
#include "scenes.h"
#include "statistics.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

RenderOptions furnace_options(uint32_t size, glm::vec3 eye, glm::vec3 at) {
  RenderOptions options;
  options.width = options.height = size;
  options.dielectric_specular = 0;
  options.camera = scenes::look_at(eye, at, {0, 1, 0}, 0.6f);
  return options;
}

/// Checks that covered pixels are `expected`: their mean within 4 standard errors, each within 6 of its own.
void check_furnace(const scenes::Scene& scene, const RenderOptions& options, uint32_t samples, double expected) {
  Renderer renderer(scene, options);
  renderer.render(0, samples);
  const Picture picture = renderer.picture();
  double sum = 0, variance = 0, covered = 0;
  for (size_t i = 0; i < picture.rgba.size(); ++i) {
    if (picture.rgba[i].w < 1) continue;
    const double error = std::sqrt(double{picture.variance[i].x});
    CHECK(std::abs(double{picture.rgba[i].x} - expected) < 6 * error + 1e-5);
    sum += double{picture.rgba[i].x}, variance += double{picture.variance[i].x}, ++covered;
  }
  REQUIRE(covered > 20);
  CAPTURE(sum / covered, expected, std::sqrt(variance) / covered);
  CHECK(std::abs(sum / covered - expected) < 4 * std::sqrt(variance) / covered + 1e-6);
}

}  // namespace

TEST_CASE("a white Lambert box in a white sky is invisible (256 samples a pixel)") {
  scenes::Scene scene = test::empty_scene();
  scene.environment = test::constant_sky(1);
  test::add_mesh(scene, test::box({-1, -1, -1}, {1, 1, 1}));
  for (const Estimator estimator : {Estimator::mis, Estimator::light_sampling, Estimator::bsdf_sampling}) {
    RenderOptions options = furnace_options(16, {3, 4, 5}, {0, 0, 0});
    options.estimator = estimator;
    check_furnace(scene, options, 256, 1);
  }
}

TEST_CASE("a white Lambert sphere in a white sky is invisible (256 samples a pixel)") {
  scenes::Scene scene = test::empty_scene();
  scene.environment = test::constant_sky(1);
  test::add_spheres(scene, {{{0, 0, 0}, 1}});
  check_furnace(scene, furnace_options(16, {0, 0, 5}, {0, 0, 0}), 256, 1);
}

TEST_CASE("a white valley in a white sky is invisible, whatever bounces about in it") {
  // Two boxes and a floor trap light for many bounces; roulette and 200 bounces lose none of it.
  scenes::Scene scene = test::empty_scene();
  scene.environment = test::constant_sky(1);
  test::add_mesh(scene, test::box({-2, -1, -2}, {-0.5f, 2, 2}));
  test::add_mesh(scene, test::box({0.5f, -1, -2}, {2, 2, 2}));
  test::add_mesh(scene, test::box({-2, -2, -2}, {2, -1, 2}));
  RenderOptions options = furnace_options(12, {0, 3, 4}, {0, -0.5f, 0});
  options.max_bounces = 200;
  check_furnace(scene, options, 256, 1);
}

TEST_CASE("an image sky of ones, sampled by its table, is a furnace too") {
  scenes::Scene scene = test::empty_scene();
  scene.images.push_back(std::make_shared<scenes::Image>(
      scenes::Image::from_pixels("sky", {16, 8, {}, std::vector<float>(4 * 16 * 8, 1.0f)})));
  scene.environment.kind = scenes::Environment::Kind::image;
  test::add_mesh(scene, test::box({-1, -1, -1}, {1, 1, 1}));
  check_furnace(scene, furnace_options(12, {3, 4, 5}, {0, 0, 0}), 256, 1);
}

TEST_CASE("a white metal shows its independently integrated directional albedo (1024 samples a pixel)") {
  for (const float roughness : {0.3f, 0.6f, 1.0f})
    for (const float cosine : {0.9f, 0.3f}) {
      scenes::Scene scene = test::empty_scene();
      scene.environment = test::constant_sky(1);
      scene.materials[0].metallic = 1, scene.materials[0].roughness = roughness;
      test::add_mesh(scene, test::quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
      scenes::SceneCamera camera =
          scenes::look_at({0, 5 * cosine, 5 * std::sqrt(1 - cosine * cosine)}, {0, 0, 0}, {0, 1, 0}, 0.5f);
      camera.kind = scenes::SceneCamera::Kind::orthographic;
      camera.ymag = 0.2f;
      RenderOptions options = furnace_options(6, {0, 1, 1}, {0, 0, 0});
      options.camera = camera;
      CAPTURE(roughness, cosine);
      check_furnace(scene, options, 1024, test::ggx_albedo(double{roughness} * roughness, cosine));
    }
}
