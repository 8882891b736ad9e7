#include "builder.h"
#include "height_grid.h"
#include "relief.h"
#include "scenes.h"
#include "shapes.h"

#include <rayloom/base/det_math.h>
#include <rayloom/scenes/camera.h>

#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr float side = 4096;  // metres
constexpr float two_pi = 6.28318531f;
constexpr float treeline = 260, snowline = 400;

enum Kind : uint8_t { shore, meadow, rock, snow };

glm::vec3 mixed(glm::vec3 a, glm::vec3 b, float t) { return a + (b - a) * t; }

/// Colours blend where materials meet, so that only their gloss changes from one triangle to the next.
Cover cover_at(uint32_t seed, glm::vec3 position, glm::vec3 normal) {
  const glm::vec2 p(position.x, position.z);
  const float patch = gradient_noise(p / 90.0f, seed * 64 + 60).value;
  const float grain = gradient_noise(p / 9.0f, seed * 64 + 61).value;
  const float height = position.y + 30 * patch + 12 * grain;
  const float grassy =
      smooth_step(0.70f, 0.82f, normal.y + 0.04f * grain) * (1 - smooth_step(treeline, treeline + 90, height));
  const float snowy =
      smooth_step(snowline - 40, snowline + 40, height) * smooth_step(0.60f, 0.72f, normal.y + 0.05f * grain);
  const float sandy = 1 - smooth_step(2, 9, position.y + 2 * patch);
  const glm::vec3 woods(0.035f, 0.075f, 0.025f), grass(0.16f, 0.22f, 0.06f);
  glm::vec3 color = mixed({0.26f, 0.23f, 0.20f}, {0.38f, 0.34f, 0.30f}, 0.5f + 0.5f * grain);
  color = mixed(color, mixed(woods, grass, smooth_step(-0.25f, 0.35f, patch + 0.3f * grain)), grassy);
  color = mixed(color, {0.48f, 0.42f, 0.30f}, sandy);
  color = mixed(color, {0.86f, 0.88f, 0.92f}, snowy);
  const Kind kind = snowy > 0.5f ? snow : sandy > 0.5f ? shore : grassy > 0.5f ? meadow : rock;
  return {color, kind};
}

void add_ground(SceneBuilder& builder, uint32_t cells, uint32_t seed) {
  HeightGrid grid{side, cells, {}, {}, {}};
  grid.materials = {{"shore", builder.material(matte("shore", glm::vec3(1)))},
                    {"meadow", builder.material(matte("meadow", glm::vec3(1)))},
                    {"rock", builder.material(glossy("rock", glm::vec3(1), 0.75f))},
                    {"snow", builder.material(glossy("snow", glm::vec3(1), 0.5f))}};
  grid.height = [relief = Relief(seed)](glm::vec2 p) { return relief.height(p); };
  grid.cover = [seed](glm::vec3 position, glm::vec3 normal) { return cover_at(seed, position, normal); };
  builder.instance(builder.mesh("ground", make_height_grid(grid)), identity_transform, "ground");
}

void add_lakes(SceneBuilder& builder) {
  constexpr float h = side / 2;
  Geometry water;
  water.name = "water";
  water.material = builder.material(glossy("water", {0.012f, 0.03f, 0.035f}, 0.06f));
  add_quad(water, {{-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h}});
  builder.instance(builder.mesh("lakes", {water}), identity_transform, "lakes");
}

void add_light(Scene& scene) {
  scene.environment.kind = Environment::Kind::gradient;
  scene.environment.zenith = {0.22f, 0.42f, 0.95f};
  scene.environment.horizon = {0.95f, 1.0f, 1.1f};
  scene.environment.nadir = {0.2f, 0.2f, 0.2f};
  Light sun;
  sun.kind = Light::Kind::directional;
  sun.name = "sun";
  sun.direction = glm::vec3(0.64f, -0.6f, -0.48f);  // unit
  sun.intensity = {5.2f, 4.6f, 3.7f};
  scene.lights.push_back(sun);
}

/// The highest of 64 places on a circle around the centre, or the lowest.
glm::vec3 place_on_circle(const Relief& relief, float radius, bool highest) {
  glm::vec3 best(0);
  for (int i = 0; i < 64; ++i) {
    const auto [s, c] = det::sincos(two_pi * static_cast<float>(i) / 64);
    const glm::vec2 p = radius * glm::vec2(c, s);
    const float height = relief.height(p);
    if (i == 0 || (highest ? height > best.y : height < best.y)) best = {p.x, height, p.y};
  }
  return best;
}

void add_cameras(SceneBuilder& builder, uint32_t seed) {
  const Relief relief(seed);
  const glm::vec3 ridge = place_on_circle(relief, 0.42f * side, true) + glm::vec3(0, 60, 0);
  builder.camera("ridge", look_at(ridge, {0, 0.35f * ridge.y, 0}, {0, 1, 0}, 0.75f));
  const glm::vec3 low = place_on_circle(relief, 0.36f * side, false);
  builder.camera("lake", look_at({low.x, std::fmax(low.y, 0.0f) + 12, low.z}, {0, 130, 0}, {0, 1, 0}, 0.8f));
  builder.camera("above", look_at({0, 2400, 3400}, {0, 0, 0}, {0, 1, 0}, 0.75f));
}

}  // namespace

Scene make_terrain(Parameters& parameters) {
  const auto cells = static_cast<uint32_t>(parameters.get("resolution", 1500, 8, 4096));
  const auto seed = static_cast<uint32_t>(parameters.get("seed", 1, 0, 1000000));
  parameters.check_all_used();
  SceneBuilder builder;
  add_ground(builder, cells, seed);
  add_lakes(builder);
  add_light(builder.scene());
  add_cameras(builder, seed);
  return builder.finish();
}

}  // namespace rayloom::scenes
