#include "atrium.h"

#include "atrium_parts.h"
#include "builder.h"
#include "pictures.h"
#include "scenes.h"
#include "shapes.h"

#include <rayloom/scenes/camera.h>

#include <algorithm>
#include <cmath>

namespace rayloom::scenes {
namespace {

using namespace atrium;

constexpr float length = bays * bay;    // of the court
constexpr float court = 7;              // its width
constexpr float row_z = court / 2;      // the columns' line
constexpr float wall_z = row_z + walk;  // the outer walls
constexpr uint32_t drape_count = 6, plant_kinds = 4;

struct Palette {
  uint32_t stone, wall, floor, ceiling, clay, leaf, brass, marble;
  uint32_t cloth[3];
};

Material textured(Material material, uint32_t texture) {
  material.base_color_texture = texture_ref(texture);
  return material;
}

Palette make_palette(SceneBuilder& builder) {
  const uint32_t tiles = builder.texture("marble tiles", marble_tiles(256));
  const uint32_t rough = builder.texture("plaster", plaster(256));
  const uint32_t weave = builder.texture("weave", woven_pattern(256));
  const uint32_t leaf_picture = builder.texture("leaf", leaf(128), Wrap::clamp_to_edge);
  Palette palette;
  palette.stone = builder.material(textured(glossy("stone", {0.95f, 0.9f, 0.82f}, 0.7f), rough));
  palette.wall = builder.material(textured(matte("wall", {0.95f, 0.82f, 0.66f}), rough));
  palette.floor = builder.material(textured(glossy("floor", glm::vec3(0.9f), 0.25f), tiles));
  palette.ceiling = builder.material(matte("ceiling", {0.7f, 0.66f, 0.6f}));
  palette.clay = builder.material(matte("clay", {0.55f, 0.25f, 0.14f}));
  Material leaf_material = textured(glossy("leaf", glm::vec3(1), 0.6f), leaf_picture);
  leaf_material.alpha_mode = AlphaMode::mask;
  leaf_material.double_sided = true;
  palette.leaf = builder.material(leaf_material);
  palette.brass = builder.material(metal("brass", {0.91f, 0.78f, 0.42f}, 0.12f));
  palette.marble = builder.material(glossy("marble", {0.85f, 0.84f, 0.82f}, 0.15f));
  const glm::vec3 colors[3] = {{0.65f, 0.06f, 0.05f}, {0.06f, 0.14f, 0.45f}, {0.75f, 0.50f, 0.08f}};
  const char* names[3] = {"red cloth", "blue cloth", "golden cloth"};
  for (int i = 0; i < 3; ++i) {
    Material cloth = textured(matte(names[i], colors[i]), weave);
    cloth.double_sided = true;
    palette.cloth[i] = builder.material(cloth);
  }
  return palette;
}

/// Where column i of a row stands along x.
float column_x(int i) { return (static_cast<float>(i) - bays / 2.0f) * bay; }

Geometry boxes(const char* name, uint32_t material, std::initializer_list<std::pair<glm::vec3, glm::vec3>> list) {
  Geometry geometry;
  geometry.name = name;
  geometry.material = material;
  for (const auto& [low, high] : list) add_box(geometry, low, high);
  return geometry;
}

void add_shell(SceneBuilder& builder, const Palette& palette) {
  constexpr float x = length / 2, top = 2 * storey + 0.6f, thick = 0.4f;
  const Geometry walls = boxes("walls", palette.wall,
                               {{{-x - thick, 0, wall_z}, {x + thick, top, wall_z + thick}},
                                {{-x - thick, 0, -wall_z - thick}, {x + thick, top, -wall_z}},
                                {{-x - thick, 0, -wall_z}, {-x, top, wall_z}},
                                {{x, 0, -wall_z}, {x + thick, top, wall_z}}});
  const Geometry floor = boxes("floor", palette.floor, {{{-x, -0.3f, -wall_z}, {x, 0, wall_z}}});
  Geometry galleries = boxes("galleries", palette.stone, {});
  for (const float side : {-1.0f, 1.0f}) {
    for (const float y : {storey, 2 * storey}) {
      const float inner = side * (row_z - 0.45f), outer = side * wall_z;
      add_box(galleries, {-x, y - 0.12f, std::min(inner, outer)}, {x, y, std::max(inner, outer)});
      add_box(galleries, {-x, y, std::min(inner, inner + side * 0.1f)},
              {x, y + 0.12f, std::max(inner, inner + side * 0.1f)});
    }
  }
  builder.instance(builder.mesh("shell", {walls, floor, galleries}), identity_transform, "shell");
}

void add_arcades(SceneBuilder& builder, const Palette& palette, uint32_t detail) {
  const uint32_t column_mesh = builder.mesh("column", {column(detail, palette.stone)});
  const uint32_t arch_mesh = builder.mesh(
      "arch", {arch(detail, palette.stone), spandrel(detail, storey - 0.12f - column_height, palette.wall)});
  for (int floor = 0; floor < 2; ++floor) {
    const float y = storey * static_cast<float>(floor);
    for (const float side : {-1.0f, 1.0f}) {
      const std::string where = (floor == 0 ? "lower " : "upper ") + std::string(side < 0 ? "north " : "south ");
      for (int i = 0; i <= bays; ++i) {
        builder.instance(column_mesh, placed({column_x(i), y, side * row_z}), where + "column " + std::to_string(i));
      }
      for (int i = 0; i < bays; ++i) {
        builder.instance(arch_mesh, placed({column_x(i) + bay / 2, y + column_height, side * row_z}),
                         where + "arch " + std::to_string(i));
      }
    }
  }
}

void add_vaults(SceneBuilder& builder, const Palette& palette, uint32_t detail) {
  const uint32_t mesh = builder.mesh("vault", {vault(detail, length, walk - 0.3f, palette.ceiling)});
  for (int floor = 0; floor < 2; ++floor) {
    for (const float side : {-1.0f, 1.0f}) {
      const float y = storey * static_cast<float>(floor + 1) - 1.05f;
      builder.instance(mesh, placed({0, y, side * (row_z + walk / 2 + 0.1f)}), "vault");
    }
  }
}

void add_drapery(SceneBuilder& builder, const Palette& palette, uint32_t detail) {
  for (uint32_t i = 0; i < drape_count; ++i) {
    const float drop = 2.2f + 0.25f * static_cast<float>(i % 3);
    const uint32_t mesh =
        builder.mesh("drape " + std::to_string(i), {drape(detail, 2.3f, drop, i, palette.cloth[i % 3])});
    const float side = i % 2 == 0 ? 1.0f : -1.0f;
    const float x = column_x(static_cast<int>(i) + (side > 0 ? 0 : 1)) + bay / 2;
    builder.instance(mesh, placed({x, storey + 3.4f, side * (row_z - 0.5f)}), "drape " + std::to_string(i));
  }
}

void add_plants(SceneBuilder& builder, const Palette& palette, uint32_t detail) {
  const uint32_t pot_mesh = builder.mesh("pot", {pot(detail, palette.clay)});
  uint32_t bushes[plant_kinds];
  for (uint32_t i = 0; i < plant_kinds; ++i) {
    bushes[i] = builder.mesh("bush " + std::to_string(i),
                             {foliage(detail, 1.1f + 0.2f * static_cast<float>(i), 200 + i, palette.leaf)});
  }
  for (uint32_t i = 0; i < 2 * bays; ++i) {
    const float side = i % 2 == 0 ? 1.0f : -1.0f;
    const glm::vec3 place(column_x(static_cast<int>(i / 2)) + bay / 2, 0, side * (row_z - 0.9f));
    const float turn = 67.0f * static_cast<float>(i);
    builder.instance(pot_mesh, placed(place), "pot " + std::to_string(i));
    builder.instance(bushes[i % plant_kinds], placed(place + glm::vec3(0, 0.48f, 0), turn),
                     "bush " + std::to_string(i));
  }
}

void add_centre(SceneBuilder& builder, const Palette& palette, uint32_t detail) {
  builder.instance(builder.mesh("fountain", {fountain(detail, palette.marble)}), placed({0, 0, 0}), "fountain");
  const uint32_t ball_mesh = builder.mesh("ball", {ball(detail, 0.35f, palette.brass)});
  for (const float x : {-5.0f, 5.0f}) builder.instance(ball_mesh, placed({x, 0, 0.6f}), "ball");
}

void add_light(Scene& scene) {
  scene.environment.kind = Environment::Kind::gradient;
  scene.environment.zenith = {0.9f, 1.3f, 2.2f};
  scene.environment.horizon = {1.6f, 1.7f, 1.8f};
  scene.environment.nadir = {0.3f, 0.28f, 0.25f};
  Light sun;
  sun.kind = Light::Kind::directional;
  sun.name = "sun";
  const glm::vec3 direction(-0.35f, -1.0f, 0.28f);
  sun.direction = direction / std::sqrt(glm::dot(direction, direction));
  sun.intensity = {14, 12.5f, 10};
  scene.lights.push_back(sun);
}

}  // namespace

void add_atrium(SceneBuilder& builder, uint32_t detail) {
  const Palette palette = make_palette(builder);
  add_shell(builder, palette);
  add_arcades(builder, palette, detail);
  add_vaults(builder, palette, detail);
  add_drapery(builder, palette, detail);
  add_plants(builder, palette, detail);
  add_centre(builder, palette, detail);
  add_light(builder.scene());
}

Scene make_atrium(Parameters& parameters) {
  const auto detail = static_cast<uint32_t>(parameters.get("detail", 1, 1, 4));
  parameters.check_all_used();
  SceneBuilder builder;
  add_atrium(builder, detail);
  builder.camera("court", look_at({-9.2f, 1.7f, 1.1f}, {4, 3.0f, -0.6f}, {0, 1, 0}, 1.05f));
  builder.camera("gallery", look_at({8.5f, storey + 1.7f, 5.2f}, {-4, 3.2f, -2.5f}, {0, 1, 0}, 1.0f));
  builder.camera("walk", look_at({-9.5f, 1.6f, 5.0f}, {6, 2.2f, 4.2f}, {0, 1, 0}, 0.95f));
  return builder.finish();
}

}  // namespace rayloom::scenes
