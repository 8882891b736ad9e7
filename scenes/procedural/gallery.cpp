#include "atrium.h"
#include "builder.h"
#include "scenes.h"
#include "shapes.h"
#include "statues.h"

#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>
#include <rayloom/scenes/camera.h>

#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr uint32_t most_statues = 36;
constexpr float plinth_height = 0.75f, plinth_side = 0.72f;

/// Where statue `index` stands and how it is turned: eight in the court, the others in the walks of both floors.
struct Place {
  glm::vec3 position;
  float degrees;
};

Place place_of(uint32_t index) {
  using namespace atrium;
  if (index < 8) {
    constexpr float along[4] = {-2.9f, 2.9f, -6.7f, 6.7f};
    const float side = index % 2 == 0 ? 1.0f : -1.0f;
    return {{along[index / 2], 0, 1.7f * side}, side > 0 ? 215.0f : 325.0f};
  }
  const uint32_t k = index - 8, column = k / 4;
  const float side = k % 2 == 0 ? -1.0f : 1.0f, floor = k % 4 < 2 ? 0.0f : storey;
  const float x = (static_cast<float>(column) + 0.5f - bays / 2.0f) * bay;
  return {{x, floor, side * (3.5f + 0.65f * walk)}, side > 0 ? 180.0f : 0.0f};
}

std::vector<uint32_t> make_materials(SceneBuilder& builder) {
  return {builder.material(glossy("white marble", {0.82f, 0.80f, 0.76f}, 0.25f)),
          builder.material(metal("bronze", {0.62f, 0.42f, 0.24f}, 0.28f)),
          builder.material(glossy("basalt", {0.07f, 0.07f, 0.075f}, 0.18f)),
          builder.material(matte("terracotta", {0.62f, 0.30f, 0.18f})),
          builder.material(metal("gold", {0.98f, 0.77f, 0.34f}, 0.15f)),
          builder.material(glossy("jade", {0.16f, 0.38f, 0.24f}, 0.12f)),
          builder.material(metal("steel", {0.66f, 0.66f, 0.68f}, 0.08f))};
}

void add_statues(SceneBuilder& builder, uint32_t count, uint64_t triangles) {
  const std::vector<uint32_t> materials = make_materials(builder);
  std::vector<Geometry> geometries(count);
  parallel_for(count, 1, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) {
      const auto& kind = statues::kinds[i % statues::kinds.size()];
      geometries[i] = kind.make(triangles, static_cast<uint32_t>(i));
      geometries[i].name = kind.name;
      statues::fit(geometries[i], 1.85f, 1.15f);
    }
  });
  for (uint32_t i = 0; i < count; ++i) {
    geometries[i].material = materials[hash64(i, 77u) % materials.size()];
    const std::string name = "statue " + std::to_string(i) + ": " + geometries[i].name;
    const Place place = place_of(i);
    // A hair below the plinth's top, so that nothing hovers.
    const glm::vec3 foot = place.position + glm::vec3(0, plinth_height - 0.004f, 0);
    builder.instance(builder.mesh(name, {std::move(geometries[i])}), placed(foot, place.degrees), name);
  }
}

/// A lamp in the walk's vault above each statue but those of the court.
void add_lamps(Scene& scene, uint32_t count) {
  for (uint32_t i = 8; i < count; ++i) {
    const glm::vec3 foot = place_of(i).position;
    Light lamp;
    lamp.kind = Light::Kind::spot;
    lamp.name = "lamp " + std::to_string(i);
    lamp.position = foot + glm::vec3(0.5f, 3.7f, foot.z > 0 ? -1.5f : 1.5f);
    const glm::vec3 down = foot + glm::vec3(0, 1.5f, 0) - lamp.position;
    lamp.direction = down / std::sqrt(glm::dot(down, down));
    lamp.intensity = {130, 104, 72};
    lamp.cos_inner_cone = 0.92f;
    lamp.cos_outer_cone = 0.80f;
    scene.lights.push_back(lamp);
  }
}

void add_plinths(SceneBuilder& builder, uint32_t count) {
  Geometry plinth;
  plinth.name = "plinth";
  plinth.material = builder.material(glossy("plinth", {0.42f, 0.40f, 0.38f}, 0.5f));
  constexpr float half = plinth_side / 2;
  add_box(plinth, {-half - 0.05f, 0, -half - 0.05f}, {half + 0.05f, 0.09f, half + 0.05f});
  add_box(plinth, {-half, 0.09f, -half}, {half, plinth_height - 0.06f, half});
  add_box(plinth, {-half - 0.04f, plinth_height - 0.06f, -half - 0.04f}, {half + 0.04f, plinth_height, half + 0.04f});
  const uint32_t mesh = builder.mesh("plinth", {plinth});
  for (uint32_t i = 0; i < count; ++i) {
    builder.instance(mesh, placed(place_of(i).position), "plinth " + std::to_string(i));
  }
}

}  // namespace

Scene make_gallery(Parameters& parameters) {
  const auto count = static_cast<uint32_t>(parameters.get("statues", most_statues, 1, most_statues));
  const auto triangles = static_cast<uint64_t>(parameters.get("triangles", 120000, 5000, 2000000));
  parameters.check_all_used();
  SceneBuilder builder;
  add_atrium(builder, 1);
  add_plinths(builder, count);
  add_statues(builder, count, triangles);
  add_lamps(builder.scene(), count);
  builder.camera("court", look_at({-10.2f, 1.9f, 0.2f}, {0, 1.7f, -0.2f}, {0, 1, 0}, 1.0f));
  builder.camera("walk", look_at({-7.5f, 1.7f, 4.3f}, {3, 1.5f, 5.2f}, {0, 1, 0}, 0.9f));
  builder.camera("balcony", look_at({6.0f, atrium::storey + 1.8f, 3.2f}, {-2, 0.6f, -0.9f}, {0, 1, 0}, 0.95f));
  return builder.finish();
}

}  // namespace rayloom::scenes
