#include <rayloom/shaders/lights.h>
#include <rayloom/shaders/renderer.h>
#include <rayloom/shaders/sampler.h>

#include "scenes.h"
#include "statistics.h"

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

scenes::Scene lit_square(float side, float3 emission, bool double_sided) {
  scenes::Scene scene = test::empty_scene();
  scene.materials[0].emissive = emission;
  scene.materials[0].double_sided = double_sided;
  test::add_mesh(scene, test::quad({-side / 2, 0, side / 2}, {side, 0, 0}, {0, 0, -side}));
  return scene;
}

LightSample draw_triangle_light(const SceneView& view, float3 position, uint32_t i) {
  Sampler sampler({i, 3}, 0, 1);
  const float4 u = sampler.next_4d();
  LightSample sample{};
  sample.position = position, sample.choice = u.z, sample.u = {u.x, u.y};
  sample_triangle_light(view, sample);
  return sample;
}

/// Form factor from a differential area facing a parallel square of side 2a at height h over its middle.
double form_factor(double a, double h) {
  const double x = a / h, s = std::sqrt(1 + x * x);
  return 4 / (2 * M_PI) * (x / s * std::atan(x / s) * 2);
}

}  // namespace

TEST_CASE("irradiance from sampled emissive triangles is the analytic form factor") {
  // A square of side 2 facing up, the receiver 1.5 above its middle looking down: E = pi L F. 200,000 samples, 4 s.e.
  Device device;
  const scenes::Scene scene = lit_square(2, {2, 2, 2}, false);
  const DeviceScene uploaded(device, scene);
  const ShaderMemoryScope scope(device);
  test::Moments irradiance;
  for (uint32_t i = 0; i < 200000; ++i) {
    const LightSample s = draw_triangle_light(uploaded.view(), {0, 1.5f, 0}, i);
    REQUIRE(s.pdf > 0);
    irradiance.add(s.radiance.x * -s.direction.y / s.pdf);
  }
  const double expected = M_PI * 2 * form_factor(1, 1.5);
  CAPTURE(irradiance.mean, expected, irradiance.standard_error());
  CHECK(std::abs(irradiance.mean - expected) < 4 * irradiance.standard_error());
}

TEST_CASE("light comes from the front only, unless the material is double-sided") {
  for (const bool double_sided : {false, true}) {
    Device device;
    const scenes::Scene scene = lit_square(1, {1, 1, 1}, double_sided);
    const DeviceScene uploaded(device, scene);
    const ShaderMemoryScope scope(device);
    CHECK(draw_triangle_light(uploaded.view(), {0, 1, 0}, 1).pdf > 0);
    CHECK((draw_triangle_light(uploaded.view(), {0, -1, 0}, 1).pdf > 0) == double_sided);
  }
}

TEST_CASE("the stated density is the one samples have, and hits are found again") {
  Device device;
  scenes::Scene scene = lit_square(2, {1, 1, 1}, false);
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].transform = {0.5f, 0, 0, 3, 0, -1, 0, 2, 0, 0, 2, 1};  // mirrored
  const DeviceScene uploaded(device, scene);
  const ShaderMemoryScope scope(device);
  const LightView& lights = uploaded.view().lights;
  REQUIRE(lights.triangles.size() == 4);
  CHECK(find_triangle_light(lights, 0, 0, 1) == 1);
  CHECK(find_triangle_light(lights, 1, 0, 1) == 3);
  // Mirrored in y, the front (object space) now faces down.
  CHECK(lights.triangles[0].normal.y == 1);
  CHECK(lights.triangles[2].normal.y == -1);
  float total = 0;
  for (uint32_t i = 0; i < 4; ++i) {
    const TriangleLight light = lights.triangles[i];
    total += light.density * 0.5f * glm::length(glm::cross(light.edge1, light.edge2));
  }
  CHECK(total == Approx(1));
  const LightSample s = draw_triangle_light(uploaded.view(), {0.2f, 1, 0.3f}, 5);
  const float distance = glm::length(s.to_light);
  CHECK(triangle_light_pdf(lights, 0, distance, -s.direction.y) == Approx(s.pdf).epsilon(1e-4));
}

TEST_CASE("instances that nothing can hit give no light") {
  Device device;
  scenes::Scene scene = lit_square(2, {1, 1, 1}, false);
  scene.instances[0].transform = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0};  // flattened
  const DeviceScene uploaded(device, scene);
  CHECK(uploaded.report().emissive_triangles == 0);
}

TEST_CASE("punctual lights follow KHR_lights_punctual") {
  scenes::Scene scene = test::empty_scene();
  scenes::Light point;
  point.position = {0, 2, 0}, point.intensity = {8, 4, 2};
  scenes::Light sun;
  sun.kind = scenes::Light::Kind::directional, sun.direction = {0, -1, 0}, sun.intensity = {3, 3, 3};
  scenes::Light spot = point;
  spot.kind = scenes::Light::Kind::spot, spot.direction = {0, -1, 0}, spot.cos_inner_cone = 0.9f,
  spot.cos_outer_cone = 0.8f;
  const auto sample = [&](const scenes::Light& light, float3 position) {
    Device device;
    scene.lights = {light};
    test::add_mesh(scene, test::quad({-1, -9, 1}, {2, 0, 0}, {0, 0, -2}));
    const DeviceScene uploaded(device, scene);
    const ShaderMemoryScope scope(device);
    LightSample s{};
    s.position = position, s.choice = 0.5f;
    sample_punctual_light(uploaded.view().lights, s);
    CHECK(s.delta == 1);
    return s;
  };
  CHECK(sample(point, {0, 0, 0}).radiance == float3(2, 1, 0.5f));
  CHECK(sample(point, {0, 0, 0}).t_max == 1);
  CHECK(sample(point, point.position).pdf == 0);
  CHECK(sample(sun, {5, 5, 5}).radiance == float3(3));
  CHECK(sample(sun, {5, 5, 5}).direction == float3(0, 1, 0));
  CHECK(sample(spot, {0, 0, 0}).radiance == float3(2, 1, 0.5f));
  CHECK(sample(spot, {2, 0, 0}).radiance == float3(0));
  point.range = 2;
  CHECK(sample(point, {0, 0, 0}).radiance == float3(0));
  point.range = 4;
  CHECK(sample(point, {0, 0, 0}).radiance.x == Approx(2 * std::pow(1 - 1.0 / 16, 2)));
}

TEST_CASE("lights of power nothing are left out") {
  Device device;
  scenes::Scene scene = lit_square(2, {0, 0, 0}, false);
  scene.lights.resize(1);
  scene.lights[0].intensity = {0, 0, 0};
  const DeviceScene uploaded(device, scene);
  CHECK(uploaded.view().light_kinds() == 0);
}
