// One picture, the same bits: any threads, instruction set, execution mode, warp size, batching and window.

#include <rayloom/accel/trace.h>
#include <rayloom/base/parallel.h>
#include <rayloom/scenes/camera.h>
#include <rayloom/shaders/renderer.h>

#include "scenes.h"

#include <catch2/catch.hpp>

#include <cstring>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

constexpr uint32_t samples = 6;

scenes::Scene masked_scene() {
  scenes::Scene scene = test::empty_scene();
  scene.materials.resize(3);
  scene.materials[1].alpha_mode = scenes::AlphaMode::blend;
  scene.materials[1].base_color = {0.9f, 0.4f, 0.2f, 0.5f};
  scene.materials[2].metallic = 1, scene.materials[2].roughness = 0.2f;
  test::add_mesh(scene, test::quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 0));
  test::add_mesh(scene, test::box({-0.5f, 0.1f, -0.5f}, {0.5f, 1.1f, 0.5f}, 1));
  test::add_spheres(scene, {{{-1, 0.4f, 0.3f}, 0.4f}, {{1, 0.3f, 0.5f}, 0.3f}}, 2);
  scene.environment.kind = scenes::Environment::Kind::gradient;
  scene.environment.zenith = {0.5f, 0.7f, 1}, scene.environment.horizon = {0.9f, 0.8f, 0.7f};
  return scene;
}

RenderOptions base_options() {
  RenderOptions options;
  options.width = 37, options.height = 23;  // no multiple of a warp
  options.seed = 5;
  options.camera = scenes::look_at({0.5f, 1.5f, 4}, {0, 0.5f, 0}, {0, 1, 0}, 0.8f);
  return options;
}

std::vector<float4> render(const scenes::Scene& scene, const RenderOptions& options, uint32_t batch = samples) {
  Renderer renderer(scene, options);
  for (uint32_t first = 0; first < samples; first += batch) renderer.render(first, std::min(batch, samples - first));
  return renderer.picture().rgba;
}

bool same_bits(const std::vector<float4>& a, const std::vector<float4>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float4)) == 0;
}

}  // namespace

TEST_CASE("independent samples are the same bits for any threads and batches, and a restart is a new renderer") {
  const scenes::Scene scene = masked_scene();
  RenderOptions options = base_options();
  options.sampler = SamplerKind::independent;
  const auto reference = render(scene, options);
  CHECK_FALSE(same_bits(reference, render(scene, base_options())));
  CHECK(same_bits(reference, render(scene, options, 1)));
  {
    const ThreadLimit limit(3);
    CHECK(same_bits(reference, render(scene, options, 4)));
  }
  Renderer renderer(scene, base_options());
  renderer.render(0, 3);
  renderer.restart(options.seed, options.sampler);
  CHECK(renderer.samples() == 0);
  renderer.render(0, samples);
  CHECK(same_bits(reference, renderer.picture().rgba));
}

TEST_CASE("any number of threads renders the same bits") {
  const scenes::Scene scene = masked_scene();
  const auto reference = render(scene, base_options());
  for (const unsigned threads : {1u, 2u, 3u, 7u}) {
    const ThreadLimit limit(threads);
    CHECK(thread_limit() == threads);
    CHECK(same_bits(render(scene, base_options()), reference));
    CHECK(threads_seen() <= threads);
  }
}

TEST_CASE("every instruction set renders the same bits") {
  const scenes::Scene scene = masked_scene();
  const accel::Isa usual = accel::current_isa();
  const auto reference = render(scene, base_options());
  for (const accel::Isa isa : {accel::Isa::scalar, accel::Isa::avx2, accel::Isa::avx512}) {
    if (!accel::isa_supported(isa)) continue;
    accel::set_isa(isa);
    CHECK(accel::current_isa() == isa);
    CHECK(same_bits(render(scene, base_options()), reference));
  }
  accel::set_isa(usual);
}

TEST_CASE("direct and warp mode and every warp size render the same bits and count the same rays") {
  const scenes::Scene scene = masked_scene();
  RenderOptions options = base_options();
  const auto reference = render(scene, options);
  const auto statistics = [&] {
    Renderer renderer(scene, options);
    renderer.render(0, samples);
    CHECK(same_bits(renderer.picture().rgba, reference));
    CHECK(renderer.last_dispatch().mode == options.dispatch.mode);
    return renderer.statistics();
  };
  options.dispatch.mode = ExecutionMode::direct;
  const DispatchStatistics direct = statistics();
  CHECK(direct.any_hit > 0);
  CHECK(direct.intersection > 0);
  CHECK(direct.callable > 0);
  options.dispatch.mode = ExecutionMode::warp;
  for (const uint32_t warp_size : {1u, 7u, 32u, 64u}) {
    options.dispatch.warp_size = warp_size;
    CHECK(statistics() == direct);
  }
}

TEST_CASE("how samples are split into batches does not show") {
  const scenes::Scene scene = masked_scene();
  const auto reference = render(scene, base_options());
  for (const uint32_t batch : {1u, 2u, 4u}) CHECK(same_bits(render(scene, base_options(), batch), reference));
}

TEST_CASE("a window or pixel has the bits of the whole picture") {
  const scenes::Scene scene = masked_scene();
  RenderOptions options = base_options();
  const auto whole = render(scene, options);
  options.window = Window{11, 9, 5, 3};
  const auto part = render(scene, options);
  for (uint32_t y = 0; y < 3; ++y)
    for (uint32_t x = 0; x < 5; ++x) CHECK(part[y * 5 + x] == whole[(9 + y) * options.width + 11 + x]);
}

TEST_CASE("seeds change the picture, and nothing else does") {
  const scenes::Scene scene = masked_scene();
  RenderOptions options = base_options();
  const auto reference = render(scene, options);
  CHECK(same_bits(render(scene, options), reference));
  options.seed = 6;
  CHECK_FALSE(same_bits(render(scene, options), reference));
}
