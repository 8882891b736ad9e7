// Light sampling, BSDF sampling and both with MIS estimate the same picture; a quadrature and a formula agree with
// them.

#include <rayloom/scenes/camera.h>
#include <rayloom/shaders/renderer.h>

#include "scenes.h"
#include "statistics.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

/// Means of the picture's luminance over independent seeds.
test::Moments picture_means(const scenes::Scene& scene, RenderOptions options, int seeds, uint32_t samples) {
  test::Moments means;
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = static_cast<uint32_t>(seed);
    Renderer renderer(scene, options);
    renderer.render(0, samples);
    double sum = 0;
    for (const float4& pixel : renderer.picture().rgba) sum += luminance(float3(pixel));
    means.add(sum / (options.width * options.height));
  }
  return means;
}

void check_estimators_agree(const scenes::Scene& scene, RenderOptions options, int seeds, uint32_t samples) {
  options.estimator = Estimator::mis;
  const test::Moments mis = picture_means(scene, options, seeds, samples);
  options.estimator = Estimator::light_sampling;
  const test::Moments light = picture_means(scene, options, seeds, samples);
  options.estimator = Estimator::bsdf_sampling;
  const test::Moments bsdf = picture_means(scene, options, seeds, samples);
  CAPTURE(mis.mean, mis.standard_error(), light.mean, light.standard_error(), bsdf.mean, bsdf.standard_error());
  CHECK(mis.mean > 0);
  CHECK(test::welch_p_value(mis, light) > test::sidak(0.001, 2));
  CHECK(test::welch_p_value(mis, bsdf) > test::sidak(0.001, 2));
}

void check_samplers_agree(const scenes::Scene& scene, RenderOptions options, int seeds, uint32_t samples) {
  for (const Estimator estimator : {Estimator::mis, Estimator::light_sampling, Estimator::bsdf_sampling}) {
    options.estimator = estimator;
    options.sampler = SamplerKind::owen_sobol;
    const test::Moments sobol = picture_means(scene, options, seeds, samples);
    options.sampler = SamplerKind::independent;
    const test::Moments independent = picture_means(scene, options, seeds, samples);
    CAPTURE(sobol.mean, sobol.standard_error(), independent.mean, independent.standard_error());
    CHECK(test::welch_p_value(sobol, independent) > test::sidak(0.001, 3));
    CHECK(sobol.variance() < independent.variance());
  }
}

RenderOptions small(uint32_t size) {
  RenderOptions options;
  options.width = options.height = size;
  return options;
}

/// A lamp, a glossy floor, a mirror ball, a textured double-sided emitter behind a masked screen, and a sky.
scenes::Scene mixed_scene() {
  scenes::Scene scene = test::empty_scene();
  scene.materials.resize(5);
  scene.materials[0].roughness = 0.3f;
  scene.materials[1].metallic = 1, scene.materials[1].roughness = 0.15f;
  scene.materials[2].metallic = 0, scene.materials[2].emissive = {4, 3, 2};
  scene.materials[2].double_sided = true;
  scene.materials[3].metallic = 0, scene.materials[3].alpha_mode = scenes::AlphaMode::mask;
  scene.materials[4].metallic = 0, scene.materials[4].alpha_mode = scenes::AlphaMode::blend;
  scene.materials[4].base_color = {0.2f, 0.9f, 0.3f, 0.5f};
  scenes::Pixels checker{2, 2, {255, 255, 255, 255, 90, 20, 20, 0, 90, 20, 20, 0, 255, 255, 255, 255}, {}};
  scene.images.push_back(std::make_shared<scenes::Image>(scenes::Image::from_pixels("checker", std::move(checker))));
  scene.textures.push_back({});
  scene.textures[0].filter = scenes::Filter::nearest;
  scene.materials[2].emissive_texture.texture = 0;
  scene.materials[3].base_color_texture.texture = 0;
  test::add_mesh(scene, test::quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 0));
  test::add_spheres(scene, {{{-0.7f, 0.5f, 0}, 0.5f}, {{0.9f, 0.3f, 0.6f}, 0.3f}}, 1);
  test::add_mesh(scene, test::quad({-0.6f, 1.2f, -1.4f}, {1.2f, 0, 0}, {0, 0.8f, 0.2f}, 2));
  test::add_mesh(scene, test::quad({-1, 1.6f, -0.5f}, {2, 0, 0}, {0, 0, 1}, 3));
  test::add_mesh(scene, test::quad({0.4f, 0, 1}, {0.6f, 0, 0}, {0, 0.9f, 0}, 4));
  scene.environment.kind = scenes::Environment::Kind::gradient;
  scene.environment.zenith = {0.3f, 0.5f, 1}, scene.environment.horizon = {0.4f, 0.3f, 0.2f};
  scenes::Light point;
  point.position = {0.5f, 2, 1.5f}, point.intensity = {1, 2, 1};
  scene.lights.push_back(point);
  return scene;
}

}  // namespace

TEST_CASE("Cornell box: the three estimators agree (Welch)") {
  const scenes::Scene scene = scenes::load_scene("cornell");
  RenderOptions options = small(16);
  options.max_bounces = 4;
  check_estimators_agree(scene, options, 12, 32);
}

TEST_CASE("Cornell box: the two samplers agree (Welch)") {
  RenderOptions options = small(16);
  options.max_bounces = 4;
  check_samplers_agree(scenes::load_scene("cornell"), options, 12, 32);
}

TEST_CASE("sky, lamps, mirrors, masks and blends: the three estimators agree (Welch)") {
  const scenes::Scene scene = mixed_scene();
  RenderOptions options = small(16);
  options.camera = scenes::look_at({0.5f, 1.5f, 4}, {0, 0.6f, 0}, {0, 1, 0}, 0.8f);
  check_estimators_agree(scene, options, 12, 64);
}

TEST_CASE("direct light under an emissive square with a blocker is what a quadrature gives") {
  // A white Lambert floor point at the origin, a lamp 2 above it, half of it hidden by a plate 1 above the floor.
  scenes::Scene scene = test::empty_scene();
  scene.materials.resize(2);
  scene.materials[1] = scene.materials[0];
  scene.materials[1].emissive = {5, 5, 5}, scene.materials[1].base_color = {0, 0, 0, 1};
  test::add_mesh(scene, test::quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, 0));
  test::add_mesh(scene, test::quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, 1));
  test::add_mesh(scene, test::quad({0.1f, 1, -2}, {3, 0, 0}, {0, 0, 4}, 0));
  RenderOptions options = small(1);
  scenes::SceneCamera camera = scenes::look_at({-3, 1.5f, 0}, {0, 0, 0}, {0, 1, 0}, 0.5f);
  camera.kind = scenes::SceneCamera::Kind::orthographic, camera.ymag = 1e-4f;
  options.camera = camera;
  options.max_bounces = 1, options.dielectric_specular = 0;

  constexpr int n = 2000;  // L cos cos / (pi r^2) over the part of the lamp whose line to the origin clears the plate
  double expected = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = -1 + 2 * (i + 0.5) / n, z = -1 + 2 * (j + 0.5) / n, r2 = x * x + z * z + 4;
      if (x / 2 < 0.1) expected += 5 * 4 / (M_PI * r2 * r2);
    }
  expected *= 4.0 / (double(n) * n);
  for (const Estimator estimator : {Estimator::mis, Estimator::light_sampling, Estimator::bsdf_sampling}) {
    options.estimator = estimator;
    Renderer renderer(scene, options);
    renderer.render(0, 65536);
    const double error = std::sqrt(double{renderer.picture().variance[0].x});
    CAPTURE(renderer.picture().rgba[0].x, expected, error);
    CHECK(std::abs(double{renderer.picture().rgba[0].x} - expected) < 4 * error);
  }
}

TEST_CASE("a point light on a Lambert plane is albedo times I cos / (pi d^2)") {
  scenes::Scene scene = test::empty_scene();
  scene.materials[0].base_color = {0.5f, 0.25f, 1, 1};
  test::add_mesh(scene, test::quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, 0));
  scenes::Light light;
  light.position = {1, 2, 0}, light.intensity = {10, 10, 10};
  scene.lights.push_back(light);
  RenderOptions options = small(1);
  scenes::SceneCamera camera = scenes::look_at({0, 3, 1}, {0, 0, 0}, {0, 1, 0}, 0.5f);
  camera.kind = scenes::SceneCamera::Kind::orthographic, camera.ymag = 1e-4f;
  options.camera = camera, options.dielectric_specular = 0;
  Renderer renderer(scene, options);
  renderer.render(0, 4);
  const double expected = 10 * (2 / std::sqrt(5.0)) / (M_PI * 5);
  CHECK(renderer.picture().rgba[0].x == Approx(0.5 * expected).epsilon(1e-3));
  CHECK(renderer.picture().rgba[0].y == Approx(0.25 * expected).epsilon(1e-3));
  CHECK(renderer.statistics().callable == 4);
}

TEST_CASE("no radiance is negative or not a number, in hostile materials and lights") {
  scenes::Scene scene = mixed_scene();
  scene.materials[1].roughness = 0;
  scene.materials[0].roughness = 0, scene.materials[0].metallic = 0.5f;
  scenes::Light inside = scene.lights[0];
  inside.position = {0, 0, 0};  // in the floor
  scene.lights.push_back(inside);
  RenderOptions options = small(48);
  options.camera = scenes::look_at({0.5f, 0.01f, 4}, {0, 0.2f, 0}, {0, 1, 0}, 0.8f);
  options.max_bounces = 30;
  for (const char* name : {"path_tracer", "ambient_occlusion"}) {
    options.program = name;
    Renderer renderer(scene, options);
    renderer.render(0, 64);
    for (const float4& pixel : renderer.picture().rgba)
      for (int c = 0; c < 4; ++c) REQUIRE((std::isfinite(pixel[c]) && pixel[c] >= 0));
  }
}
