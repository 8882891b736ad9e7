// What follows from measurements that follow a law; and that a biased picture is found out.

#include <rayloom/tools/bench/error/error_report.h>
#include <rayloom/tools/bench/error/experiment.h>
#include <rayloom/tools/bench/error/lamp_scenes.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace rayloom;
using namespace rayloom::bench;

namespace {

/// Error `scale` * spp^exponent, a tenth more or less by seed, at `rate` samples a second.
ErrorCurve power_law(double scale, double exponent, double rate) {
  ErrorCurve curve;
  curve.spp = {1, 4, 16, 64};
  for (int seed = 0; seed < 4; ++seed) {
    curve.seeds.emplace_back();
    for (const uint32_t spp : curve.spp) {
      Measurement m;
      m.error.mse = scale * std::pow(spp, exponent) * (seed % 2 ? 1.1 : 0.9);
      m.error.relmse = 2 * m.error.mse;
      m.error.trimmed_relmse = m.error.mse;
      m.seconds = spp / rate;
      curve.seeds.back().push_back(m);
    }
  }
  return curve;
}

}  // namespace

TEST_CASE("slope, time to an error and comparison of power laws") {
  const ErrorCurve plain = power_law(1, -1, 10), better = power_law(0.5, -1.2, 5);
  CHECK(mse_slope(plain).value == Approx(-1));
  CHECK(mse_slope(plain).standard_error < 1e-6);  // all seeds have the same slope
  CHECK(relmse_slope(better).value == Approx(-1.2));
  CHECK(plain.relmse(0).value == Approx(2));
  CHECK(plain.mse(0).standard_error == Approx(0.2 / std::sqrt(12.0)));

  const TimeToError time = time_to_relmse(plain, 0.1);  // 2 / spp: 20 samples
  CHECK(time.kind == TimeToError::Kind::within);
  CHECK(time.spp == Approx(20));
  CHECK(time.seconds == Approx(2));
  CHECK(time_to_relmse(plain, 3).kind == TimeToError::Kind::before_first);
  CHECK(time_to_relmse(plain, 0.001).kind == TimeToError::Kind::after_last);

  const CurveRatio ratio = compare(better, plain);
  for (const Estimate& error : {ratio.mse, ratio.relmse, ratio.trimmed_relmse})
    CHECK(error.value == Approx(0.5 * std::pow(64, -0.2)));
  CHECK(ratio.time.median == Approx(2));
  CHECK(ratio.mse_efficiency.value == Approx(1 / (ratio.mse.value * 2)));
}

TEST_CASE("--check fails above a slope of -0.95 and for a bias, and passes below") {
  SceneErrors scene;
  scene.scene = "law";
  const auto all_met = [&](double exponent, Bias bias) {
    scene.curves = {power_law(1, exponent, 10)};
    scene.curves[0].bias = bias;
    BenchReport report("error", "test");
    add_results(report, {scene});
    return report.targets.all_met();
  };
  CHECK(all_met(-1, {}));
  CHECK(all_met(-1.4, {1, 1}));
  CHECK_FALSE(all_met(-0.94, {}));
  CHECK_FALSE(all_met(-1, {6, 1}));
}

TEST_CASE("a slope that one spark decides is told, but misses nothing; a flat one that all seeds agree on does") {
  SceneErrors scene;
  scene.scene = "law";
  scene.curves = {power_law(1, -1, 10)};
  scene.curves[0].seeds[2].back().error.mse = 100;
  CHECK(is_undetermined(mse_slope(scene.curves[0])));
  BenchReport sparks("error", "test");
  add_results(sparks, {scene});
  CHECK(sparks.targets.all_met());
  CHECK(sparks.text.find("not determined") != std::string::npos);
  scene.curves = {power_law(1, -0.5, 10)};
  BenchReport flat("error", "test");
  add_results(flat, {scene});
  CHECK_FALSE(flat.targets.all_met());
}

TEST_CASE("rendered: the slope of independent samples is near -1, and there is no bias") {
  const scenes::Scene scene = load_error_scene(large_lamps);
  ErrorSettings settings;
  settings.spp = {1, 4, 16}, settings.seeds = 4, settings.reference_spp = 1600;
  settings.width = 24, settings.height = 16;
  settings.configurations = {{shaders::SamplerKind::independent, shaders::Estimator::mis}};
  ReferenceFile nothing("", settings.width, settings.height);
  const SceneErrors errors = measure_scene(scene, settings, nothing, false);
  CHECK(mse_slope(errors.curves[0]).value == Approx(-1).margin(0.1));
  CHECK(std::abs(errors.curves[0].bias.sigmas()) < max_bias_sigmas);
  CHECK(errors.reference_error.relmse < 0.05 * errors.curves[0].relmse(2).value);
}

TEST_CASE("rendered: paths cut short against whole ones are a bias, and flatten the slope") {
  const scenes::Scene scene = load_error_scene("cornell");
  shaders::RenderOptions options;
  options.width = 24, options.height = 16;
  shaders::Renderer whole(scene, options);
  const Reference reference = render_reference(whole, 1600, [](uint64_t) {});
  options.max_bounces = 1;
  shaders::Renderer cut(scene, options);
  ErrorCurve curve{{}, {1, 4, 16}, {}, {}};
  SeedSpread spread;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    cut.restart(seed, shaders::SamplerKind::owen_sobol);
    curve.seeds.emplace_back();
    for (const uint32_t spp : curve.spp) {
      cut.render(cut.samples(), spp - cut.samples());
      curve.seeds.back().push_back({picture_error(cut.picture(), reference), {}, 1});
    }
    spread.add(cut.picture());
  }
  CHECK(relmse_slope(curve).value > max_slope);
  CHECK_FALSE(is_undetermined(relmse_slope(curve)));
  CHECK(spread.squared_bias(reference).sigmas() > max_bias_sigmas);
}

TEST_CASE("the two lamp scenes send out the same power, and are what a name says") {
  CHECK(load_error_scene(small_lamps).meshes.size() > load_error_scene(large_lamps).meshes.size());
  CHECK(load_error_scene("cornell").name == "cornell");
  const auto lamp_power = [](const scenes::Scene& scene) {
    double power = 0;
    for (const scenes::Mesh& mesh : scene.meshes) {
      const scenes::Geometry& g = mesh.geometries[0];
      const double area = glm::length(glm::cross(g.positions[1] - g.positions[0], g.positions[3] - g.positions[0]));
      power += area * scene.materials[g.material].emissive.x;
    }
    return power;
  };
  CHECK(lamp_power(load_error_scene(small_lamps)) == Approx(lamp_power(load_error_scene(large_lamps))).epsilon(1e-5));
}
